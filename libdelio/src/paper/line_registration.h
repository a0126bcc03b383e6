#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/estimates.h"
#include "core/kd_tree.h"
#include "delio/core/odometry_options.h"
#include "paper/line_cloud.h"

namespace delio::paper {
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

/** Line of `from` that a line of `to` is paired with. */
struct Match {
    std::uint32_t from = 0;
    float distance = -1;  //!< of the midpoints; negative: none
};

/** Finds the lines of one cloud whose midpoints are nearest to those of others. The tree is asked
 *  again only for a line that has moved so far since that another midpoint may be nearer than
 *  those that were found. */
class LineMatcher {
 public:
    /** `from` has to outlive it. */
    explicit LineMatcher(const LineCloud& from);

    /** For each line of `to` moved by `t`, the line of `from` with the nearest midpoint within
     *  `farthest` (metres). */
    std::vector<Match> matches(const LineCloud& to, const Eigen::Vector3d& t, double farthest);

    const LineCloud& from() const { return from_; }  //!< that it finds lines of

 private:
    /** What was found for a line of `to` where it was then. */
    struct Found {
        static constexpr std::size_t kMost = 8;

        Eigen::Vector3f at = Eigen::Vector3f::Zero();
        std::array<std::uint32_t, kMost> nearest;
        std::size_t count = 0;
        float others_m = -1;  //!< all others are at least so far away
    };
    Found find(const Eigen::Vector3f& at) const;
    Match nearestOf(const Found& found, const Eigen::Vector3f& at) const;

    const LineCloud& from_;
    KdTree tree_;
    std::vector<Found> found_;  //!< of each line of the last `to`
};

/** registerLines() and searchTranslation() with what `matcher` of `from` knows already. */
TranslationEstimate registerLines(LineMatcher& matcher, const LineCloud& to,
                                  const Eigen::Vector3d& predicted,
                                  const LineRegistrationOptions& options);
/** See registerLines(). */
TranslationEstimate searchTranslation(LineMatcher& matcher, const LineCloud& to,
                                      const Eigen::Vector3d& centre, double radius,
                                      const LineRegistrationOptions& options);

/** Mean of the matches' distances: pairs farther apart are dropped (section IV-B). */
double meanDistance(const std::vector<Match>& matches);
}  // namespace delio::paper
