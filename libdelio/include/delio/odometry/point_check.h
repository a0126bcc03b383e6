#pragma once
#include "delio/points/point_map.h"
#include "delio/points/point_registration.h"

namespace delio {
/** When points overrule the lines. */
struct PointCheckOptions : public StageOptions {
    bool enabled = true;
    double believed = 0.1;
    double believed_deg = 0.5;
    double map_spacing = 0.1;
    double point_spacing = 1.0;
    double rest = 0.3;
    double min_moved = 0.3;
    double min_share = 0.15;
    double reach = 4;

 protected:
    std::vector<OptionField> fields() const override;
};

/** A scan as others are checked against it, and it against others; sensor's frame. */
struct CheckPoints {
    Eigen::Matrix3Xd points;  //!< metres, thinned: these are asked
    points::PointMap map;     //!< what others are asked in
    /** Turns the sensor's frame such that z is up. */
    Eigen::Matrix3f upright = Eigen::Matrix3f::Identity();
};
/** `points`: metres, sensor's frame; `upright` as in CheckPoints. */
CheckPoints checkPointsOf(const Eigen::Matrix3Xf& points, const Eigen::Matrix3f& upright,
                          const PointCheckOptions& options, const points::PointMapOptions& map);

/** What points say of where scan `to` stands in scan `from`, beside what was `predicted` and
 * `found` (both map frame `to` to frame `from`) with other features. A standstill explains the
 * rings on the ground, wherever the sensor went, and so would confirm itself; therefore only those
 * points are asked that a standstill does not explain. Not valid where these cannot tell: too few
 * of them, or too few that lie on points of `from` in the best place. `reach`: metres that may have
 * been driven. */
points::PointEstimate checkByPoints(const CheckPoints& from, const CheckPoints& to,
                                    const Eigen::Isometry3d& found,
                                    const Eigen::Isometry3d& predicted, double reach,
                                    const PointCheckOptions& options,
                                    const points::PointRegistrationOptions& registration);

/** True if it is the same place within what is `believed`. */
bool agree(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b,
           const PointCheckOptions& options);
}  // namespace delio
