#include "line_matches.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace delio::paper {
LineMatcher::LineMatcher(const LineCloud& from) : from_(from), tree_(from.midpoints) {}

LineMatcher::Found LineMatcher::find(const Eigen::Vector3f& at) const {
    std::uint32_t nearest[2] = {0, 0};
    float squared[2] = {0, 0};
    const std::size_t count = tree_.nearest(at, 2, nearest, squared);
    if (count == 0) return {at, 0, -1};
    const float reach = count == 1 ? std::numeric_limits<float>::infinity()
                                   : (std::sqrt(squared[1]) - std::sqrt(squared[0])) / 2;
    return {at, nearest[0], reach};
}

std::vector<Match> LineMatcher::matches(const LineCloud& to, const Eigen::Vector3d& t,
                                        double farthest) {
    const auto count = static_cast<std::size_t>(to.midpoints.cols());
    std::vector<Match> matches(count);
    if (from_.midpoints.cols() == 0) return matches;
    found_.resize(count);
    const Eigen::Vector3f moved = t.cast<float>();
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 128),
        [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                Found& found = found_[i];
                const Eigen::Vector3f at = to.midpoints.col(static_cast<Eigen::Index>(i)) + moved;
                if (!((at - found.at).norm() < found.reach)) found = find(at);
                const float distance =
                    (from_.midpoints.col(static_cast<Eigen::Index>(found.from)) - at).norm();
                if (distance <= static_cast<float>(farthest)) matches[i] = {found.from, distance};
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
