#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "../core/kd_tree.h"
#include "delio/paper/line_cloud.h"

namespace delio::paper {
/** Line of `from` that a line of `to` is paired with. */
struct Match {
    std::uint32_t from = 0;
    float distance = -1;  //!< of the midpoints; negative: none
};

/** For each line of `to` moved by `t`, the line with the nearest midpoint within `farthest`
 *  (metres); `tree` holds the midpoints of `from`. */
std::vector<Match> nearestMidpoints(const KdTree& tree, const LineCloud& to,
                                    const Eigen::Vector3d& t, double farthest);

/** Mean of the matches' distances: pairs farther apart are dropped (section IV-B). */
double meanDistance(const std::vector<Match>& matches);
}  // namespace delio::paper
