#pragma once
#include <Eigen/Core>

#include "delio/core/estimates.h"
#include "delio/core/stage_options.h"
#include "delio/paper/line_cloud.h"

namespace delio::paper {
/** Section IV-B. Two skew lines see only the part of the translation along their common normal;
 *  with `centroids` = true each step is the difference of the centroids of the closest points, as
 *  the paper writes it, which shrinks the step along directions that few pairs see and so takes
 *  many iterations. Otherwise each step goes straight to where those steps end for the pairs at
 *  hand: the least squares solution over the pairs' common normals; and pairs of nearly parallel
 *  lines are left out. Those have no common normal, so that they would hold the estimate within
 *  their surface too; the rings on the ground look the same wherever the sensor stands, and with
 *  them slow drives stood still. Pairs count by how far the noise of their ends leaves them a
 * common normal (`short_length`). */
struct LineRegistrationOptions : public StageOptions {
    bool centroids = false;
    double min_angle_deg = 15;
    double short_length = 0.06;
    double max_distance = 5;
    unsigned max_iterations = 40;
    double converged = 0.001;
    unsigned min_matches = 100;
    double min_observability = 0.03;
    double independent_share = 0.25;
    double overlap_distance = 0.5;
    double prior_sigma = 0.5;
    double search_speed = 30;
    double search_radius = 8;
    double search_step = 1;

 protected:
    std::vector<OptionField> fields() const override;
};

/** The translation that brings the lines of `to`, already turned into the axes of `from`, onto
 *  those of `from`: nearest midpoints, pairs farther apart than the mean dropped, closest points of
 *  the two infinite lines, iterated to convergence from the prediction. */
TranslationEstimate registerLines(const LineCloud& from, const LineCloud& to,
                                  const Eigen::Vector3d& predicted,
                                  const LineRegistrationOptions& options);

/** The same where little is known of the motion (a drive's first pair, or after scans were lost):
 *  registered from starts all over a horizontal disc of `radius` metres about `centre`, and the
 *  result taken whose lines lie nearest to each other. From a start at rest alone, the rings that
 * the sensor draws on the ground would hold the estimate there: they look the same wherever the
 * sensor stands. */
TranslationEstimate searchTranslation(const LineCloud& from, const LineCloud& to,
                                      const Eigen::Vector3d& centre, double radius,
                                      const LineRegistrationOptions& options);

/** The closest points X_s, X_t of two infinite lines P + t u, the paper's formulas. Nothing is
 *  divided where the lines are parallel: then `parallel` is true, X_s is P_s, and X_t the point of
 *  the other line next to it. */
struct ClosestPoints {
    Eigen::Vector3d onSource;  //!< X_s
    Eigen::Vector3d onTarget;  //!< X_t
    bool parallel = false;     //!< the angle between the lines is below `min_angle_deg`
};
/** P: a point of each line; u: its direction. Metres, one frame. */
ClosestPoints closestPoints(const Eigen::Vector3d& Ps, const Eigen::Vector3d& us,
                            const Eigen::Vector3d& Pt, const Eigen::Vector3d& ut,
                            double min_angle_deg);
}  // namespace delio::paper
