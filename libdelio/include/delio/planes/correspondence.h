#pragma once
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <vector>

#include "delio/planes/plane_map.h"

namespace delio::planes {
/** A correspondence: a point of a scan, and the plane of the map that it lies next to. */
struct Correspondence {
    Eigen::Vector3d point;   //!< metres, the sensor's frame
    Eigen::Vector3d normal;  //!< unit, the map's frame
    Eigen::Vector3d mean;    //!< a point of the plane, metres, the map's frame
    double weight = 0;       //!< 1/m^2: robust weight over variance
    double tilt = 0;         //!< rad^2: how uncertain the normal's direction is
    std::size_t index = 0;   //!< of the point in the scan

    /** Distance to the plane of the point at pose (R, t), metres, signed. */
    double residual(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) const {
        return normal.dot(R * point + t - mean);
    }
};
/** Of one scan, in the order of its points. */
using Correspondences = std::vector<Correspondence>;

/** Finds them for one scan, over and over: most points stay in their voxels from one pose to the
 *  next. */
class Matcher {
 public:
    /** Keeps references to the map, which must not change, and to the points (metres, the sensor's
     *  frame), whose coordinates may change between two calls but not their number.
     *  `point_sigma`: of a measured point, metres. Not for several threads at once. */
    Matcher(const PlaneMap& map, const Eigen::Matrix3Xd& points, double point_sigma);

    /** Points next to a plane of the map at `pose` (sensor to map), with robust weights
     *  (Geman-McClure of width `kernel`, metres) over the variance of plane and point. In the order
     *  of the points. */
    Correspondences at(const Eigen::Isometry3d& pose, double kernel);

    /** How well those points that fall into voxels with a plane lie on it at `pose`, 0 to 1. What
     *  is seen for the first time does not count. */
    double shareAt(const Eigen::Isometry3d& pose, double kernel);

 private:
    /** So many points, one after the other, are looked up together. */
    static constexpr std::size_t kBlock = 512;
    std::size_t blocks() const { return (latest_.size() + kBlock - 1) / kBlock; }
    std::size_t endOf(std::size_t block) const {
        return std::min(latest_.size(), (block + 1) * kBlock);
    }
    /** Of a block's points, metres, the map's frame. */
    using Placed = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kBlock>;
    Placed findPlanes(std::size_t block, const Eigen::Isometry3d& pose);
    Correspondences matchesOf(std::size_t block, const Placed& placed, double kernel) const;

    const PlaneMap& map_;
    const Eigen::Matrix3Xd& points_;
    double point_sigma_;
    struct Place {
        std::uint64_t voxel = ~std::uint64_t{0};  //!< that no point is in
        const Plane* plane = nullptr;
    };
    std::vector<Place> latest_;  //!< of the points
};
}  // namespace delio::planes
