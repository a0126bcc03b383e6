#include "graph/doubtful_edges.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "graph/chain.h"
#include "graph/residual.h"

namespace delio::graph {
namespace {
/** Only edges over at most so many steps vote on each of these steps. */
constexpr std::size_t kShort = 10;
constexpr std::size_t kNone = static_cast<std::size_t>(-1);

Vector6 errorOf(const PoseGraph& graph, const Edge& edge) {
    return residualOf(edge.increment.pose, graph.poses()[edge.from], graph.poses()[edge.to]).error;
}

/** The steps between successive nodes: step i leads from node i to node i+1. */
class Steps {
 public:
    Steps(const PoseGraph& graph, double width)
        : edges_(graph.poses().size(), kNone),
          chain_(graph.poses().size()),
          unknown_(graph.poses().size(), 0) {
        for (std::size_t i = 0; i < graph.edges().size(); ++i) {
            const Edge& edge = graph.edges()[i];
            if (std::max(edge.from, edge.to) - std::min(edge.from, edge.to) != 1) continue;
            std::size_t& best = edges_[std::min(edge.from, edge.to)];
            if (best == kNone || squaredError(graph, i) < squaredError(graph, best)) best = i;
        }
        for (std::size_t step = 0; step + 1 < graph.poses().size(); ++step) {
            const std::size_t i = edges_[step];
            const bool known = i != kNone && squaredError(graph, i) <= width * width;
            unknown_[step + 1] = unknown_[step] + (known ? 0 : 1);
            if (!known) continue;
            const Edge& edge = graph.edges()[i];
            chain_.set(step, edge.increment.covariance, graph.poses()[edge.to]);
        }
        chain_.sumUp();
    }

    std::size_t edgeOf(std::size_t step) const { return edges_[step]; }

    /** The chain has all steps between the two nodes. */
    bool knows(std::size_t first, std::size_t last) const {
        return unknown_[first] == unknown_[last];
    }

    const Chain& chain() const { return chain_; }

 private:
    static double squaredError(const PoseGraph& graph, std::size_t i) {
        const Vector6 e = errorOf(graph, graph.edges()[i]);
        return e.dot(graph.information(i) * e);
    }

    std::vector<std::size_t> edges_;    //!< of each step, the best of several
    Chain chain_;                       //!< of the steps that are known
    std::vector<std::size_t> unknown_;  //!< steps that are not known, counted up to each node
};
}  // namespace

std::vector<bool> doubtfulEdges(const PoseGraph& graph, double width) {
    const auto& edges = graph.edges();
    const Steps steps(graph, width);
    std::vector<bool> doubtful(edges.size(), false);
    std::vector<unsigned> against(graph.poses().size(), 0), agreeing(graph.poses().size(), 0);
    const auto spanOf = [](const Edge& edge) { return std::minmax(edge.from, edge.to); };
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const auto [first, last] = spanOf(edges[i]);
        if (steps.edgeOf(first) == i || !steps.knows(first, last)) continue;
        const Matrix6 A = adjointOf(graph.poses()[edges[i].to].inverse());
        const Matrix6 covariance =
            edges[i].increment.covariance + A * steps.chain().between(first, last) * A.transpose();
        const Vector6 e = errorOf(graph, edges[i]);
        doubtful[i] = e.dot(covariance.ldlt().solve(e)) > width * width;
        if (last - first > kShort) continue;
        for (std::size_t step = first; step < last; ++step)
            ++(doubtful[i] ? against : agreeing)[step];
    }
    std::vector<std::size_t> wrongSteps(graph.poses().size() + 1, 0);  // counted up to each node
    for (std::size_t step = 0; step < graph.poses().size(); ++step)
        wrongSteps[step + 1] = wrongSteps[step] + (against[step] >= 2 && agreeing[step] == 0);
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const auto [first, last] = spanOf(edges[i]);
        if (wrongSteps[first] != wrongSteps[last]) doubtful[i] = steps.edgeOf(first) == i;
    }
    return doubtful;
}
}  // namespace delio::graph
