#pragma once
#include <Eigen/Geometry>

#include "delio/core/odometry_options.h"
#include "odometry/point_map.h"
#include "odometry/register_points.h"

// Two guards that the paper does not have, for the profile `paper-extended`: the rotation is found
// again from the normals at one place, and a registration of points may overrule pattern and lines.
namespace delio::odometry {
struct PaperFeatures;
struct PaperRegistration;

/** A scan as others are checked against it, and it against others; sensor's frame. */
struct CheckPoints {
    Eigen::Matrix3Xd points;  //!< metres, thinned: these are asked
    PointMap map;             //!< what others are asked in
    /** Turns the sensor's frame such that z is up. */
    Eigen::Matrix3f upright = Eigen::Matrix3f::Identity();
};
/** `points`: metres, sensor's frame; `upright` as in CheckPoints. */
CheckPoints checkPointsOf(const Eigen::Matrix3Xf& points, const Eigen::Matrix3f& upright,
                          const PointCheckOptions& options, const PointMapOptions& map);

/** What points say of where scan `to` stands in scan `from`, beside what was `predicted` and
 * `found` (both map frame `to` to frame `from`) with other features. A standstill explains the
 * rings on the ground, wherever the sensor went, and so would confirm itself; therefore only those
 * points are asked that a standstill does not explain. Not valid where these cannot decide: too few
 * of them, or too few that lie on points of `from` in the best place. `reach`: metres that may have
 * been driven. */
PointEstimate checkByPoints(const CheckPoints& from, const CheckPoints& to,
                            const Eigen::Isometry3d& found, const Eigen::Isometry3d& predicted,
                            double reach, const PointCheckOptions& options,
                            const PointRegistrationOptions& registration);

/** True if both are the same place within the tolerance. */
bool agree(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b,
           const PointCheckOptions& options);

/** What the enabled guards make of `found`, which pattern and lines gave from `guess`: rotation and
 *  translation again from the normals at one place; where points say that the scan stands
 * elsewhere, all again from there. An axis along or about which that still leads away stays where
 * the points put it, and is named as unobserved. */
void applyGuards(const PaperFeatures& from, const PaperFeatures& to, const Eigen::Isometry3d& guess,
                 const PaperOdometryOptions& options, PaperRegistration& found);

/** The same for a link of the pose graph: false where points contradict it. Nothing is searched:
 *  where the scan stands is known already. */
bool applyGuardsToLink(const PaperFeatures& from, const PaperFeatures& to,
                       const Eigen::Isometry3d& guess, const PaperOdometryOptions& options,
                       PaperRegistration& found);
}  // namespace delio::odometry
