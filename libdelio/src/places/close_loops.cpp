#include "places/close_loops.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "delio/core/stopwatch.h"
#include "graph/chain.h"
#include "graph/residual.h"
#include "places/closure.h"

namespace delio::places {
namespace {
/** Covariance added by drift, which grows with the path, not with the number of scans. */
Matrix6 driftOf(const graph::Edge& step, const LoopOptions& options) {
    constexpr double kPer_m = 100;
    const double share = step.increment.pose.translation().norm() / kPer_m,
                 metres = options.drift * kPer_m, radians = kDrift_deg * M_PI / 180;
    Vector6 variances;
    variances << Eigen::Vector3d::Constant(metres * metres * share),
        Eigen::Vector3d::Constant(radians * radians * share);
    return variances.asDiagonal();
}

/** How far loops lie from where the chain between successive nodes leads. */
class ChainErrors {
 public:
    ChainErrors(const graph::PoseGraph& graph, const LoopOptions& options)
        : poses_(graph.poses()), own_(poses_.size()), drift_(poses_.size()) {
        for (const auto& edge : graph.edges())
            if (edge.to == edge.from + 1) {
                own_.set(edge.from, edge.increment.covariance, poses_[edge.to]);
                drift_.set(edge.from, driftOf(edge, options), poses_[edge.to]);
            }
        own_.sumUp();
        drift_.sumUp();
    }

    /** Squared error of the chain between the two ends of an edge that is true, for each degree of
     *  freedom: by what the odometry says of itself, and `factor` times the expected drift. */
    double excess(const graph::Edge& edge, double factor) const {
        const auto [first, last] = std::minmax(edge.from, edge.to);
        const Matrix6 A = adjointOf(poses_[edge.to].inverse()),
                      sum =
                          own_.between(first, last) + factor * factor * drift_.between(first, last);
        const Matrix6 covariance = A * sum * A.transpose() + edge.increment.covariance;
        const Vector6 e =
            graph::residualOf(edge.increment.pose, poses_[edge.from], poses_[edge.to]).error;
        return e.dot(covariance.ldlt().solve(e)) / 6;
    }

 private:
    const std::vector<Eigen::Isometry3d>& poses_;
    graph::Chain own_, drift_;
};

/** Edges that the graph does not have yet. */
std::vector<graph::Edge> edgesOf(const std::vector<LoopCandidate>& candidates,
                                 const graph::PoseGraph& graph) {
    std::set<std::pair<std::size_t, std::size_t>> there;
    for (const auto& edge : graph.edges()) there.emplace(edge.from, edge.to);
    std::vector<graph::Edge> edges;
    for (const auto& loop : candidates) {
        if (!loop.accepted() || there.count({loop.fromNode, loop.toNode}) > 0) continue;
        edges.push_back({loop.fromNode, loop.toNode, loop.closure.increment});
        edges.back().increment.covariance.diagonal() += kBendingInDrive.variances();
    }
    return edges;
}

/** With which the median of the loops is as likely as it should be; one that is wrong has no say.
 */
double driftFactor(const graph::PoseGraph& graph, const std::vector<graph::Edge>& loops,
                   const LoopOptions& options) {
    const ChainErrors chain(graph, options);
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
        refuseInconsistent(candidates, search.submaps(), level, search.options());
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

graph::PoseGraph closedBy(const graph::PoseGraph& graph, const graph::Edge& loop,
                          const LoopOptions& options) {
    return withLoops(graph, {loop}, driftFactor(graph, {loop}, options), options);
}

namespace {
constexpr double kDeg = M_PI / 180;
constexpr double kChi2 = 22.5;  // 99.9 % of six degrees of freedom

/** How unlikely it is that a drive is off by that much after such a stretch: a chi-square. */
double chi2Of(const Eigen::Isometry3d& off, const PathSegment& driven, const LoopOptions& options) {
    constexpr double kFloor_m = 0.3, kFloor_deg = 0.5;  // of registrations, and of what is level
    const Drift drift = driftOf(driven, options);
    const Eigen::Vector3d t = off.translation();
    return (t.head<2>() / (kFloor_m + drift.level_m)).squaredNorm() +
           std::pow(t.z() / (kFloor_m + drift.up_m), 2) +
           std::pow(angleOf(off.linear()) / (kFloor_deg * kDeg + drift.turn_rad), 2);
}

class Consistency {
 public:
    Consistency(const std::vector<LoopCandidate>& candidates, const std::vector<Submap>& submaps,
                const std::vector<Eigen::Isometry3d>& level, const LoopOptions& options)
        : candidates_(candidates), submaps_(submaps), level_(level), options_(options) {}

    bool leadsTooFar(const LoopCandidate& loop) const {
        const Eigen::Isometry3d off = chain(loop.to, loop.from) * loop.closure.level;
        const PathSegment driven = between(submaps_[loop.to].driven, submaps_[loop.from].driven);
        return chi2Of(off, driven, options_) > kChi2;
    }

    /** Once round: along one loop, on to where the other one is, and back along that. */
    bool agree(const LoopCandidate& a, const LoopCandidate& b) const {
        const Eigen::Isometry3d round =
            a.closure.level * chain(a.to, b.to) * b.closure.level.inverse() * chain(b.from, a.from);
        return chi2Of(round, apart(a, b), options_) <= kChi2;
    }

    /** Along the drive, at both ends together. */
    PathSegment apart(const LoopCandidate& a, const LoopCandidate& b) const {
        return between(submaps_[a.to].driven, submaps_[b.to].driven) +
               between(submaps_[a.from].driven, submaps_[b.from].driven);
    }

    /** Numbers of candidates that all agree with each other: the one that agrees with most first,
     *  then whatever goes with all before it. */
    std::vector<std::size_t> clique(const std::vector<std::size_t>& loops) const {
        std::vector<std::size_t> friends(candidates_.size(), 0), order = loops, chosen;
        for (const auto i : loops)
            for (const auto k : loops) friends[i] += agree(candidates_[i], candidates_[k]);
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t i, std::size_t k) { return friends[i] > friends[k]; });
        for (const auto i : order)
            if (std::all_of(chosen.begin(), chosen.end(),
                            [&](std::size_t k) { return agree(candidates_[i], candidates_[k]); }))
                chosen.push_back(i);
        return chosen;
    }

 private:
    /** By the chain: the level frame of `to` to that of `from`. */
    Eigen::Isometry3d chain(std::size_t from, std::size_t to) const {
        return level_[from].inverse() * level_[to];
    }

    const std::vector<LoopCandidate>& candidates_;
    const std::vector<Submap>& submaps_;
    const std::vector<Eigen::Isometry3d>& level_;
    const LoopOptions& options_;
};
}  // namespace

void refuseInconsistent(std::vector<LoopCandidate>& candidates, const std::vector<Submap>& submaps,
                        const std::vector<Eigen::Isometry3d>& level, const LoopOptions& options) {
    const Consistency consistency(candidates, submaps, level, options);
    for (auto& loop : candidates)
        if (loop.accepted() && consistency.leadsTooFar(loop))
            loop.closure.reason = "farther away than the odometry can have drifted";
    std::vector<std::size_t> loops;
    for (std::size_t i = 0; i < candidates.size(); ++i)
        if (candidates[i].accepted()) loops.push_back(i);
    const auto chosen = consistency.clique(loops);
    constexpr double kNeighbours_m = 150;
    for (const auto i : loops) {
        auto& loop = candidates[i];
        const auto isNeighbour = [&](std::size_t k) {
            return k != i && consistency.apart(loop, candidates[k]).path_m <= kNeighbours_m;
        };
        if (std::find(chosen.begin(), chosen.end(), i) == chosen.end())
            loop.closure.reason = "inconsistent with other loops";
        else if (std::none_of(chosen.begin(), chosen.end(), isNeighbour))
            loop.closure.reason = "not confirmed by a neighbouring submap";
    }
}
}  // namespace delio::places
