#include "line_matches.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace delio::paper {
LineMatcher::LineMatcher(const LineCloud& from) : from_(from), tree_(from.midpoints) {}

LineMatcher::Found LineMatcher::find(const Eigen::Vector3f& at) const {
    Found found;
    found.at = at;
    std::array<float, Found::kMost> squared{};
    found.count = tree_.nearest(at, Found::kMost, found.nearest.data(), squared.data());
    found.others_m = found.count == Found::kMost ? std::sqrt(squared.back())
                                                 : std::numeric_limits<float>::infinity();
    return found;
}

Match LineMatcher::nearestOf(const Found& found, const Eigen::Vector3f& at) const {
    Match best;
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < found.count; ++i) {
        const std::uint32_t from = found.nearest[i];
        const float squared =
            (from_.midpoints.col(static_cast<Eigen::Index>(from)) - at).squaredNorm();
        if (squared >= least) continue;
        least = squared;
        best.from = from;
    }
    best.distance = std::sqrt(least);
    return best;
}

std::vector<Match> LineMatcher::matches(const LineCloud& to, const Eigen::Vector3d& t,
                                        double farthest) {
    const auto count = static_cast<std::size_t>(to.midpoints.cols());
    std::vector<Match> matches(count);
    if (from_.midpoints.cols() == 0) return matches;
    found_.resize(count);
    const Eigen::Vector3f moved = t.cast<float>();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 128),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i != range.end(); ++i) {
                              Found& found = found_[i];
                              const Eigen::Vector3f at =
                                  to.midpoints.col(static_cast<Eigen::Index>(i)) + moved;
                              Match nearest = nearestOf(found, at);
                              if (!(nearest.distance + (at - found.at).norm() < found.others_m)) {
                                  found = find(at);
                                  nearest = nearestOf(found, at);
                              }
                              if (nearest.distance <= static_cast<float>(farthest))
                                  matches[i] = nearest;
                          }
                      });
    return matches;
}

double meanDistance(const std::vector<Match>& matches) {
    double distances = 0, count = 0;
    for (const auto& match : matches)
        if (match.distance >= 0) {
            distances += static_cast<double>(match.distance);
            count += 1;
        }
    return distances / std::max(count, 1.0);
}
}  // namespace delio::paper
