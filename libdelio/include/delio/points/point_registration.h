#pragma once
#include <Eigen/Geometry>

#include "delio/core/geometry.h"
#include "delio/points/point_map.h"

namespace delio::points {
/** How a scan is registered to points. */
struct PointRegistrationOptions : public StageOptions {
    double first_kernel = 2.0;
    double least_kernel = 0.3;
    double last_kernel = 0.2;
    unsigned max_iterations = 100;
    double converged_m = 5e-3;
    unsigned min_matches = 50;
    double min_share = 0.1;

    void check(const std::string& section) const override;

 protected:
    std::vector<OptionField> fields() const override;
};

/** A scan registered to the map of points. */
struct PointEstimate {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< sensor to map
    /** Inlier ratio: of the points those within the last kernel of one of the map's, 0 to 1. */
    double share = 0;
    double residual_m = 0;    //!< root mean square distance of these
    std::size_t matches = 0;  //!< pairs that it stands on
    unsigned iterations = 0;  //!< in all
    bool converged = false;   //!< false: ended by the most iterations that are allowed
    double kernel_m = 0;      //!< width that it began with
    /** False: too few correspondences, and the pose is the prediction; or too small a share. */
    bool valid = false;
};

/** Point-to-point registration, decoupled as the planes' is: each point is paired with the nearest
 *  one of the map. Pairs taken about their weighted centroids are free of the translation: they
 * give the rotation alone (SVD), and the centroids then the translation alone. With new pairs each
 * time, while the Geman-McClure kernel narrows from `kernel` (metres) to last_kernel. */
PointEstimate registerToPoints(const PointMap& map, const Eigen::Matrix3Xd& points,
                               const Eigen::Isometry3d& predicted, double kernel,
                               const PointRegistrationOptions& options);

/** The way from a to b, metres: of the sensor, in the map's frame, and of what it sees at a typical
 *  range, about its axes. */
Vector6 stepBetween(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b);

/** Share of the points that lie within `distance` (metres) of one of the map's, 0 to 1. */
double shareAt(const PointMap& map, const Eigen::Matrix3Xd& points, const Eigen::Isometry3d& pose,
               double distance);

/** The points that do not. */
Eigen::Matrix3Xd pointsOff(const PointMap& map, const Eigen::Matrix3Xd& points,
                           const Eigen::Isometry3d& pose, double distance);
}  // namespace delio::points
