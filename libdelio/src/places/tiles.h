#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <functional>
#include <vector>

namespace delio::places {
/** The columns of all parts, one part after the other. */
Eigen::Matrix3Xf together(const std::vector<Eigen::Matrix3Xf>& parts);

/** Edge of the squares into which a cloud is cut. PlaceIndex searches 20 m about the middle of a
 *  place. */
constexpr double kTile_m = 30;

/** What a scan sees that was taken in a tile: points of this tile and of those around it, metres,
 *  in its level frame.
 *  @param level of each tile: maps its level frame to the map's
 *  @param pointsOf points of a tile in its own level frame */
Eigen::Matrix3Xf surroundings(std::size_t tile, const std::vector<Eigen::Isometry3d>& level,
                              const std::function<Eigen::Matrix3Xf(std::size_t)>& pointsOf);
}  // namespace delio::places
