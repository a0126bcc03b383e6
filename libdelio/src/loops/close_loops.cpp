#include "delio/loops/close_loops.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "delio/core/stopwatch.h"
#include "delio/graph/residual.h"
#include "support.h"

namespace delio::loops {
namespace {
/** What a registration of submaps is off beside its noise: they are bent by the drift within them.
 */
constexpr double kBent_m = 0.05, kBent_rad = 0.2 * M_PI / 180;

/** What a drift adds to the covariance of a step: it goes with the path, not with the scans. */
Matrix6 driftOf(const graph::Edge& step, const LoopOptions& options) {
    constexpr double kPer_m = 100;
    const double share = step.increment.pose.translation().norm() / kPer_m,
                 metres = options.drift * kPer_m, radians = options.drift_deg * M_PI / 180;
    Vector6 variances;
    variances << Eigen::Vector3d::Constant(metres * metres * share),
        Eigen::Vector3d::Constant(radians * radians * share);
    return variances.asDiagonal();
}

/** The chain between successive nodes, summed up. */
class Chain {
 public:
    Chain(const graph::PoseGraph& graph, const LoopOptions& options)
        : poses_(graph.poses()),
          own_(poses_.size(), Matrix6::Zero()),
          drift_(poses_.size(), Matrix6::Zero()) {
        for (const auto& edge : graph.edges())
            if (edge.to == edge.from + 1) {
                const Matrix6 A = adjointOf(poses_[edge.to]);
                own_[edge.to] = A * edge.increment.covariance * A.transpose();
                drift_[edge.to] = A * driftOf(edge, options) * A.transpose();
            }
        for (std::size_t i = 1; i < poses_.size(); ++i) {
            own_[i] += own_[i - 1];
            drift_[i] += drift_[i - 1];
        }
    }

    /** Squared error of the chain between the two ends of an edge that is true, for each degree of
     *  freedom: by what the odometry says of itself, and `factor` times the expected drift. */
    double excess(const graph::Edge& edge, double factor) const {
        const auto [first, last] = std::minmax(edge.from, edge.to);
        const Matrix6 A = adjointOf(poses_[edge.to].inverse()),
                      sum = own_[last] - own_[first] +
                            factor * factor * (drift_[last] - drift_[first]);
        const Matrix6 covariance = A * sum * A.transpose() + edge.increment.covariance;
        const Vector6 e =
            graph::residualOf(edge.increment.pose, poses_[edge.from], poses_[edge.to]).error;
        return e.dot(covariance.ldlt().solve(e)) / 6;
    }

 private:
    const std::vector<Eigen::Isometry3d>& poses_;
    std::vector<Matrix6> own_, drift_;
};

/** Edges that the graph does not have yet. */
std::vector<graph::Edge> edgesOf(const std::vector<LoopCandidate>& candidates,
                                 const graph::PoseGraph& graph) {
    std::set<std::pair<std::size_t, std::size_t>> there;
    for (const auto& edge : graph.edges()) there.emplace(edge.from, edge.to);
    Vector6 bent;
    bent << Eigen::Vector3d::Constant(kBent_m * kBent_m),
        Eigen::Vector3d::Constant(kBent_rad * kBent_rad);
    std::vector<graph::Edge> edges;
    for (const auto& loop : candidates) {
        if (!loop.accepted() || there.count({loop.fromNode, loop.toNode}) > 0) continue;
        edges.push_back({loop.fromNode, loop.toNode, loop.closure.increment});
        edges.back().increment.covariance.diagonal() += bent;
    }
    return edges;
}

/** With which the median of the loops is as likely as it should be; one that is wrong has no say.
 */
double driftFactor(const graph::PoseGraph& graph, const std::vector<graph::Edge>& loops,
                   const LoopOptions& options) {
    const Chain chain(graph, options);
    const auto isTooSmall = [&](double factor) {
        std::vector<double> excess;
        excess.reserve(loops.size());
        for (const auto& loop : loops) excess.push_back(chain.excess(loop, factor));
        const auto middle = excess.begin() + static_cast<std::ptrdiff_t>(excess.size() / 2);
        std::nth_element(excess.begin(), middle, excess.end());
        return *middle > 1;
    };
    if (!isTooSmall(0)) return 0;
    double low = 1e-4, high = 10;
    while (high > 1.05 * low) {
        const double middle = std::sqrt(low * high);
        (isTooSmall(middle) ? low : high) = middle;
    }
    return high;
}

graph::PoseGraph withLoops(const graph::PoseGraph& graph, const std::vector<graph::Edge>& loops,
                           double factor, const LoopOptions& options) {
    graph::PoseGraph closed;
    for (const auto& pose : graph.poses()) closed.addNode(pose);
    for (auto edge : graph.edges()) {
        edge.increment.covariance += factor * factor * driftOf(edge, options);
        closed.addEdge(edge);
    }
    for (const auto& loop : loops) closed.addEdge(loop);
    return closed;
}

double mostMoved(const std::vector<Eigen::Isometry3d>& a, const std::vector<Eigen::Isometry3d>& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        most = std::max(most, (a[i].translation() - b[i].translation()).norm());
    return most;
}
}  // namespace

ClosedLoops closeLoops(const graph::PoseGraph& graph, LoopSearch& search,
                       const graph::PoseGraphOptions& optimisation) {
    constexpr double kMuch_m = 5;
    constexpr int kSearches = 3;
    const auto level = levelFrames(search.submaps(), graph.poses());
    ClosedLoops result;
    result.graph = graph;
    for (int i = 0; i < kSearches; ++i) {
        const auto before = result.graph.poses();
        if (i > 0) search.again(before);
        auto candidates = search.candidates();
        refuseUnsupported(candidates, search.submaps(), level, search.options());
        const auto loops = edgesOf(candidates, graph);
        if (i > 0 && loops.size() < result.accepted) break;
        result.candidates = std::move(candidates);
        result.accepted = loops.size();
        if (loops.empty()) break;
        result.drift_factor = driftFactor(graph, loops, search.options());
        result.graph = withLoops(graph, loops, result.drift_factor, search.options());
        result.optimisation =
            timed(result.optimise_ms, [&] { return result.graph.optimise(optimisation); });
        if (mostMoved(before, result.graph.poses()) < kMuch_m) break;
    }
    return result;
}
}  // namespace delio::loops
