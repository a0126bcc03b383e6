#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace delio::scan {
/** The ring (laser) of each point of a spinning LiDAR, from 0, for a cloud that does not say. In
 *  whatever order the points come, rings are the modes of their elevations, from the top. Where
 *  those are blurred (an HDL-64E's beams do not come from one point, and points that were brought
 *  to one stamp have moved), ring after ring is told by the order, as KITTI's files have it: a ring
 *  ends where the azimuth falls back by more than half a turn. Where nothing looks like rings,
 *  points are put into 64 equal steps of elevation. */
std::vector<std::uint16_t> ringsOf(const Eigen::Matrix3Xf& points);

/** The same rings numbered from the highest mean elevation (0) down, so that consecutive numbers
 *  are neighbours: Velodyne numbers its lasers in the order in which they fire. */
std::vector<std::uint16_t> ringsFromTop(const Eigen::Matrix3Xf& points,
                                        const std::vector<std::uint16_t>& rings);
}  // namespace delio::scan
