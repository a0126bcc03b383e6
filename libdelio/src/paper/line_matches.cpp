#include "line_matches.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace delio::paper {
std::vector<Match> nearestMidpoints(const KdTree& tree, const LineCloud& to,
                                    const Eigen::Vector3d& t, double farthest) {
    std::vector<Match> matches(static_cast<std::size_t>(to.midpoints.cols()));
    tbb::parallel_for(std::size_t{0}, matches.size(), [&](std::size_t i) {
        const Eigen::Vector3f moved =
            to.midpoints.col(static_cast<Eigen::Index>(i)) + t.cast<float>();
        float squared = 0;
        if (tree.nearest(moved, 1, &matches[i].from, &squared) == 1 &&
            squared <= static_cast<float>(farthest * farthest))
            matches[i].distance = std::sqrt(squared);
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
