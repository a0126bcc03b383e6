#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <set>
#include <vector>

#include "core/voxel_table.h"
#include "odometry/preprocess.h"

namespace delio::odometry {
/** Finds parts of the own vehicle: what stays at one place in the sensor's frame while the sensor
 *  moves, ends on all sides within reach, and is above the ground. The ground, and walls beside a
 *  road, may stay at one place, too, but go on beyond reach. */
class OwnVehicle {
 public:
    /** Takes a scan in: points in the sensor's frame (metres), which `upright` turns such that z is
     *  up. `pose`: sensor to map. */
    void add(const Eigen::Matrix3Xf& points, const Eigen::Matrix3f& upright,
             const Eigen::Isometry3d& pose);

    /** The cloud without the points of the parts that were found. */
    PointCloud without(PointCloud cloud) const;

    /** Of the parts that were found, metres, sensor's frame; empty: none. */
    const Eigen::AlignedBox3d& box() const { return box_; }

 private:
    using Voxel = std::uint64_t;
    std::set<Voxel> steady() const;
    void judge();

    /** A voxel, how many scans had points there, and the number of the latest one that had. */
    struct Count {
        Voxel voxel = 0;
        unsigned scans = 0, latest = 0;
    };
    VoxelIndex numbers_;                                       //!< of the voxels in counts_
    std::vector<Count> counts_;                                //!< since the latest judgement
    unsigned scans_ = 0;                                       //!< that were counted
    Eigen::Vector3d latest_ = Eigen::Vector3d::Constant(1e9);  //!< place of the latest of them
    std::set<Voxel> before_;                                   //!< steady in the scans before these
    std::set<Voxel> own_;                                      //!< with a margin about them
    Eigen::AlignedBox3d box_;
};
}  // namespace delio::odometry
