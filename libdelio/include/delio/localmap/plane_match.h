#pragma once
#include <Eigen/Core>
#include <vector>

namespace delio::localmap {
/** A point of a scan, and the plane of the map that it lies next to. */
struct PlaneMatch {
    Eigen::Vector3d point;   //!< metres, the sensor's frame
    Eigen::Vector3d normal;  //!< unit, the map's frame
    Eigen::Vector3d mean;    //!< a point of the plane, metres, the map's frame
    double weight = 0;       //!< 1/m^2: robust weight over variance

    /** Distance to the plane of the point at pose (R, t), metres, signed. */
    double residual(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) const {
        return normal.dot(R * point + t - mean);
    }
};
using PlaneMatches = std::vector<PlaneMatch>;
}  // namespace delio::localmap
