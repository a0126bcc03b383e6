#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace delio::scan {
/** The ring (laser) of each point of a spinning LiDAR, from 0, for a cloud that does not say.
 *  Sensors and KITTI's files give ring after ring, each once round: a ring ends where the azimuth
 *  falls back by more than half a turn. Where that does not give rings of one elevation each (the
 *  order is another one), points are put into 64 equal steps of elevation. */
std::vector<std::uint16_t> ringsOf(const Eigen::Matrix3Xf& points);
}  // namespace delio::scan
