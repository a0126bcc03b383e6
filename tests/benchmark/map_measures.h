#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

namespace delio {
/** A scan's points, sensor's frame, metres: every second one, and those between. */
struct SplitScan {
    Eigen::Matrix3Xf used, heldOut;
};

/** Poses, sensor to map, one a scan. */
using Poses = std::vector<Eigen::Isometry3d>;

/** Distances of points to the plane of their 20 neighbours, metres, in the order of the points;
 *  NaN where the neighbourhood is no plane. */
using Distances = std::vector<double>;

/** Points of all scans, by scan: what a map is made of. The choice is made once and is the same for
 *  all poses that are compared, so that these differ in nothing else. */
struct MapPoints {
    Eigen::Matrix3Xf points;        //!< sensor's frame
    std::vector<std::size_t> scan;  //!< of each point
};

/** The scans' `used` points thinned to centroids of `spacing` (metres), of which one is left in
 * each voxel of that size in the map that `rough` poses give: as dense as one scan, drawn from all.
 */
MapPoints mapPoints(const std::vector<SplitScan>& scans, const Poses& rough, double spacing);

/** The `heldOut` points, one in each voxel of `spacing` of a scan. */
MapPoints heldOutPoints(const std::vector<SplitScan>& scans, double spacing);

/** Each point of the map against its 20 neighbours. */
Distances mapThickness(const MapPoints& map, const Poses& poses);

/** Each point of `queries` against its 20 neighbours among the points of *other* scans. */
Distances heldOutResiduals(const MapPoints& map, const MapPoints& queries, const Poses& poses);
}  // namespace delio
