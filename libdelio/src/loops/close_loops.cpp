#include "delio/loops/close_loops.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "delio/graph/residual.h"
#include "support.h"

namespace delio::loops {
namespace {
/** What a registration of submaps is off beside its noise: they are bent by the drift within them.
 */
constexpr double kBent_m = 0.05, kBent_rad = 0.2 * M_PI / 180;

/** The chain between successive nodes, summed up. */
class Chain {
 public:
    explicit Chain(const graph::PoseGraph& graph)
        : poses_(graph.poses()), covariances_(poses_.size(), Matrix6::Zero()) {
        for (const auto& edge : graph.edges())
            if (edge.to == edge.from + 1) {
                const Matrix6 A = adjointOf(poses_[edge.to]);
                covariances_[edge.to] = A * edge.increment.covariance * A.transpose();
            }
        for (std::size_t i = 1; i < covariances_.size(); ++i)
            covariances_[i] += covariances_[i - 1];
    }

    /** Squared error of the chain between the two ends of an edge that is true, by what the chain
     *  says of itself, for each degree of freedom. */
    double excess(const graph::Edge& edge) const {
        const auto [first, last] = std::minmax(edge.from, edge.to);
        const Matrix6 A = adjointOf(poses_[edge.to].inverse());
        const Matrix6 covariance = A * (covariances_[last] - covariances_[first]) * A.transpose();
        const Vector6 e =
            graph::residualOf(edge.increment.pose, poses_[edge.from], poses_[edge.to]).error;
        return e.dot((covariance + edge.increment.covariance).ldlt().solve(e)) / 6;
    }

 private:
    const std::vector<Eigen::Isometry3d>& poses_;
    std::vector<Matrix6> covariances_;
};

std::vector<graph::Edge> edgesOf(const std::vector<LoopCandidate>& candidates) {
    Vector6 bent;
    bent << Eigen::Vector3d::Constant(kBent_m * kBent_m),
        Eigen::Vector3d::Constant(kBent_rad * kBent_rad);
    std::vector<graph::Edge> edges;
    for (const auto& loop : candidates) {
        if (!loop.accepted()) continue;
        edges.push_back({loop.fromNode, loop.toNode, loop.closure.increment});
        edges.back().increment.covariance.diagonal() += bent;
    }
    return edges;
}

/** The median over the loops; one that is wrong has no say. */
double driftFactor(const graph::PoseGraph& graph, const std::vector<graph::Edge>& loops) {
    const Chain chain(graph);
    std::vector<double> excess;
    excess.reserve(loops.size());
    for (const auto& loop : loops) excess.push_back(chain.excess(loop));
    const auto middle = excess.begin() + static_cast<std::ptrdiff_t>(excess.size() / 2);
    std::nth_element(excess.begin(), middle, excess.end());
    return std::sqrt(std::max(1.0, *middle));
}

graph::PoseGraph withLoops(const graph::PoseGraph& graph, const std::vector<graph::Edge>& loops,
                           double factor) {
    graph::PoseGraph closed;
    for (const auto& pose : graph.poses()) closed.addNode(pose);
    for (auto edge : graph.edges()) {
        edge.increment.covariance *= factor * factor;
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

ClosedLoops closeLoops(const graph::PoseGraph& graph, const std::vector<Submap>& submaps,
                       const LoopOptions& options, const ClosureOptions& closure,
                       const graph::PoseGraphOptions& optimisation) {
    constexpr double kMuch_m = 5;
    constexpr int kSearches = 3;
    ClosedLoops result;
    result.graph = graph;
    for (int i = 0; i < kSearches; ++i) {
        const auto before = result.graph.poses();
        auto candidates = searchLoops(submaps, before, options, closure, result.candidates);
        refuseUnsupported(candidates, submaps, graph.poses(), options);
        const auto loops = edgesOf(candidates);
        if (i > 0 && loops.size() < result.accepted) break;
        result.candidates = std::move(candidates);
        result.accepted = loops.size();
        if (loops.empty()) break;
        result.drift_factor = driftFactor(graph, loops);
        result.graph = withLoops(graph, loops, result.drift_factor);
        result.optimisation = result.graph.optimise(optimisation);
        if (mostMoved(before, result.graph.poses()) < kMuch_m) break;
    }
    return result;
}
}  // namespace delio::loops
