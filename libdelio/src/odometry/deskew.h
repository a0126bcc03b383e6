#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/scan_trajectory.h"
#include "core/voxel_grid.h"
#include "odometry/preprocess.h"

namespace delio::odometry {
/** When each point of a turning LiDAR was measured, from its azimuth: seconds from the moment at
 *  which the sensor looked ahead (x), where the stamp of KITTI's raw scans is. A sweep of `sweep_s`
 *  begins at the back and runs clockwise seen from above, as Velodyne's do. */
std::vector<float> azimuthTimes(const Eigen::Matrix3Xf& points, double sweep_s);

/** The points (metres, sensor's frame at each point's own time) as the sensor would have seen them
 *  all at once at the scan's time. `times_s`: of each point, seconds from then; of the trajectory,
 * too, which maps the sensor's frame to what it is then. */
Eigen::Matrix3Xf deskew(const Eigen::Matrix3Xf& points, const std::vector<float>& times_s,
                        const ScanTrajectory& trajectory);

/** A scan as it is registered against a map: undistorted, in the sensor's frame at the scan's time,
 *  dynamic objects left out of the thinned points. Metres. */
struct ScanView {
    Eigen::Matrix3Xf points;            //!< all
    std::vector<std::uint8_t> dynamic;  //!< 1 for each of them that belongs to a dynamic object
    VoxelNumbers voxels;                //!< of all points
    std::vector<std::uint8_t> dynamicVoxels;  //!< 1 for each of these that is dynamic
    Eigen::Matrix3Xf fine;     //!< thinned for the map: centroids of the static voxels
    VoxelNumbers fineVoxels;   //!< of `fine`
    Eigen::Matrix3Xd thinned;  //!< thinned for registration by planes
    Eigen::Matrix3Xd coarse;   //!< thinned for registration by points
    Eigen::Matrix3Xd level;    //!< all, thinned: where `coarse` has no ground, they level the scan
    /** Of each of these two its column in `fine`, before dynamic ones were left out. */
    std::vector<Eigen::Index> coarseColumns, levelColumns;
};

/** Undistorted by `trajectory` (see deskew()) where the points have times; not thinned yet,
 *  nothing dynamic. */
ScanView undistorted(const PointCloud& cloud, const ScanTrajectory& trajectory);

/** The columns of `points` that are not marked. */
Eigen::Matrix3Xf unmarked(const Eigen::Matrix3Xf& points, const std::vector<std::uint8_t>& marks);

/** Thins view.fine for registration by points: all points at `spacing` metres, or only those
 *  that stand above the ground at `spacing` / 2, unless these are few: the rings that a sensor
 * draws on the ground lie on those of the scan before wherever it stands. `upright` turns the
 * sensor's z up. */
void thinForPoints(ScanView& view, const Eigen::Matrix3f& upright, double spacing, bool byStanding);

/** Thins the points for the map: view.fine are the centroids of voxels of `spacing` metres. */
void thinForMap(ScanView& view, double spacing);

/** Numbers the voxels of `spacing` metres of view.fine. */
void numberForPlanes(ScanView& view, double spacing);

/** Marks voxels of view.voxels as dynamic (1), and leaves them out of view.fine. view.coarse and
 *  view.level keep them. */
void leaveOutDynamic(ScanView& view, std::vector<std::uint8_t> dynamicVoxels);

/** Thins view.fine for registration by planes: the centroids of the voxels that were numbered. */
void thinForPlanes(ScanView& view);

/** The column in view.points of the first point in each voxel of numberForPlanes(). */
std::vector<Eigen::Index> firstsForPlanes(const ScanView& view);

/** The same scan, undistorted by a trajectory that hardly differs. Its points share the voxels that
 *  they share in `view`, which is thinned for the map and numbered for planes. Dynamic ones are
 * left out. */
ScanView undistortedAgain(const PointCloud& cloud, const ScanTrajectory& trajectory,
                          const ScanView& view);

/** The same for any trajectory, along which points of one voxel may part. Its voxels are new:
 *  their edges are `mapSpacing`, and `planeSpacing` for the planes (metres). `dynamic`: 1 for each
 *  point that is left out. */
ScanView undistortedAnew(const PointCloud& cloud, const ScanTrajectory& trajectory,
                         const std::vector<std::uint8_t>& dynamic, double mapSpacing,
                         double planeSpacing);
}  // namespace delio::odometry
