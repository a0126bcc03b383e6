#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "../core/kd_tree.h"
#include "delio/core/estimates.h"
#include "delio/paper/line_cloud.h"
#include "delio/paper/line_registration.h"

namespace delio::paper {
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
