#include "delio/localisation/anchored_graph.h"

#include <algorithm>

#include "delio/core/error.h"

namespace delio {
namespace {
/** What a map is off beside the noise of a registration: it has been driven once. */
constexpr double kMap_m = 0.02, kMap_rad = 1e-3;

/** The drive's nodes in the map: from each that was measured on by the odometry, and back from the
 *  first. */
std::vector<Eigen::Isometry3d> posesIn(const std::vector<Eigen::Isometry3d>& odometry,
                                       const std::vector<MapFix>& fixes) {
    const auto first = std::find_if(fixes.begin(), fixes.end(), isAnchor);
    if (first == fixes.end()) throw Error("no scan was found in the map");
    auto anchor = static_cast<std::size_t>(first - fixes.begin());
    std::vector<Eigen::Isometry3d> poses;
    for (std::size_t i = 0; i < odometry.size(); ++i) {
        if (isAnchor(fixes[i])) anchor = i;
        poses.push_back(
            normalised(fixes[anchor].vehicle.pose * (odometry[anchor].inverse() * odometry[i])));
    }
    return poses;
}
}  // namespace

bool isAnchor(const MapFix& fix) { return fix.measured && fix.where == Whereabouts::kInMap; }

graph::PoseGraph anchored(const graph::PoseGraph& graph, const std::vector<MapFix>& fixes) {
    const auto poses = posesIn(graph.poses(), fixes);
    graph::PoseGraph result;
    for (const auto& pose : poses) result.addNode(pose);
    for (const auto& edge : graph.edges()) result.addEdge(edge);
    for (std::size_t i = 1; i < fixes.size(); ++i) {
        if (!isAnchor(fixes[i])) continue;
        graph::Edge edge{0, i, {poses[0].inverse() * poses[i], fixes[i].vehicle.covariance}};
        edge.increment.covariance.diagonal().head<3>().array() += kMap_m * kMap_m;
        edge.increment.covariance.diagonal().tail<3>().array() += kMap_rad * kMap_rad;
        result.addEdge(edge);
    }
    return result;
}
}  // namespace delio
