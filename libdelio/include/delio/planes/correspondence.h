#pragma once
#include <Eigen/Geometry>
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

    /** Distance to the plane of the point at pose (R, t), metres, signed. */
    double residual(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) const {
        return normal.dot(R * point + t - mean);
    }
};
using Correspondences = std::vector<Correspondence>;

/** Points next to a plane of the map at `pose` (sensor to map), with robust weights (Geman-McClure
 *  of width `kernel`, metres) over the variance of plane and point. In the order of the points. */
Correspondences findCorrespondences(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                                    const Eigen::Isometry3d& pose, double kernel,
                                    double point_sigma);
}  // namespace delio::planes
