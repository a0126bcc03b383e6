#include "delio/graph/pose_graph.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>
#include <string>

#include "delio/core/error.h"
#include "graph/doubtful_edges.h"
#include "graph/levmarq_seam.h"
#include "graph/residual.h"

namespace delio::graph {
namespace {
/** Farther than anything on earth, squares lose the metres. */
bool isFinite(const Eigen::Isometry3d& pose) {
    constexpr double kFarthest_m = 1e9;
    return pose.linear().allFinite() && (pose.translation().array().abs() <= kFarthest_m).all();
}

void requireFinite(const Eigen::Isometry3d& pose, std::size_t node) {
    if (!isFinite(pose))
        throw Error("pose graph: the pose of node " + std::to_string(node) +
                    " is not finite or exceeds 1e9 m");
}

bool isPositiveDefinite(const Matrix6& m) {
    return m.allFinite() && (m - m.transpose()).norm() <= 1e-9 * m.norm() &&
           m.llt().info() == Eigen::Success;
}

Matrix6 inverseOf(const Matrix6& m) {
    const Matrix6 inverse = m.llt().solve(Matrix6::Identity());
    return (inverse + inverse.transpose()) / 2;
}

std::string nameOf(std::size_t from, std::size_t to) {
    return "the edge from node " + std::to_string(from) + " to node " + std::to_string(to);
}
}  // namespace

std::vector<OptionField> PoseGraphOptions::fields() const {
    return {
        {"skip_edges", &PoseGraphOptions::skip_edges,
         "edges in addition to (i,i+1): 1 adds (i,i+2), 2 also (i,i+3); 0: none", 0, 100},
        {"min_overlap", &PoseGraphOptions::min_overlap,
         "minimum fraction of a scan's lines with a line of the other scan nearby, for such an "
         "edge",
         0, 1},
        {"window", &PoseGraphOptions::window,
         "number of latest nodes optimised during the drive; 0: optimise only at the end", 0, 1000},
        {"max_iterations", &PoseGraphOptions::max_iterations,
         "maximum number of Levenberg-Marquardt steps", 1, 100000},
        {"kernel_width", &PoseGraphOptions::kernel_width,
         "standard deviations; width of the Geman-McClure kernel; 0: no robust kernel", 0, 1e9}};
}

std::size_t PoseGraph::addNode(const Eigen::Isometry3d& initial) {
    requireFinite(initial, poses_.size());
    poses_.push_back(initial);
    edgesUpTo_.emplace_back();
    return poses_.size() - 1;
}

void PoseGraph::addEdge(const Edge& edge) {
    if (!isPositiveDefinite(edge.increment.covariance))
        throw Error("pose graph: the covariance of " + nameOf(edge.from, edge.to) +
                    " is not symmetric and positive definite");
    append(edge, inverseOf(edge.increment.covariance));
}

void PoseGraph::addEdge(std::size_t from, std::size_t to, const Eigen::Isometry3d& pose,
                        const Matrix6& information) {
    if (!isPositiveDefinite(information))
        throw Error("pose graph: the information of " + nameOf(from, to) +
                    " is not symmetric and positive definite");
    append({from, to, {pose, inverseOf(information)}}, information);
    information_.emplace(edges_.size() - 1, information);
}

Matrix6 PoseGraph::information(std::size_t i) const {
    const auto given = information_.find(i);
    return given != information_.end() ? given->second : inverseOf(edges_[i].increment.covariance);
}

void PoseGraph::correct(const std::vector<NodePose>& corrected) {
    for (const auto& [node, pose] : corrected) {
        requireFinite(pose, node);
        poses_.at(node) = pose;
    }
    const auto follow = [&](std::size_t node) {
        for (const std::size_t i : edgesUpTo_[node])
            if (auto& [from, to, increment] = edges_[i]; to == from + 1)
                increment.pose = poses_[from].inverse() * poses_[to];
    };
    for (const auto& [node, pose] : corrected) {
        follow(node);
        if (node + 1 < poses_.size()) follow(node + 1);
    }
}

PoseGraph PoseGraph::withPoses(const std::vector<Eigen::Isometry3d>& poses) const {
    if (poses.size() != poses_.size())
        throw Error("pose graph: " + std::to_string(poses.size()) + " poses for " +
                    std::to_string(poses_.size()) + " nodes");
    for (std::size_t i = 0; i < poses.size(); ++i) requireFinite(poses[i], i);
    PoseGraph moved = *this;
    moved.poses_ = poses;
    return moved;
}

void PoseGraph::append(const Edge& edge, const Matrix6& information) {
    const std::string name = nameOf(edge.from, edge.to);
    if (edge.from >= poses_.size() || edge.to >= poses_.size())
        throw Error("pose graph: " + name + " refers to missing nodes (there are " +
                    std::to_string(poses_.size()) + ")");
    if (edge.from == edge.to) throw Error("pose graph: " + name + " connects a node to itself");
    if (!isFinite(edge.increment.pose))
        throw Error("pose graph: " + name + " is not finite or exceeds 1e9 m");
    // Finite too: a covariance of 1e-320 has no inverse in doubles.
    if (!isPositiveDefinite(information))
        throw Error("pose graph: the covariance of " + name + " cannot be inverted");
    // Beyond this squares overflow in the solver, which then never ends.
    constexpr double kMostInformation = 1e20;
    if (information.cwiseAbs().maxCoeff() > kMostInformation)
        throw Error("pose graph: the information of " + name +
                    " exceeds 1e20, which is not plausible");
    edgesUpTo_[std::max(edge.from, edge.to)].push_back(edges_.size());
    edges_.push_back(edge);
}

void PoseGraph::requireConnected(std::size_t firstFree) const {
    // Connected nodes have the same representative (union-find); the fixed nodes are one, number 0.
    const auto numberOf = [&](std::size_t node) {
        return node < firstFree ? 0 : node - firstFree + 1;
    };
    std::vector<std::size_t> parent(poses_.size() - firstFree + 1);
    std::iota(parent.begin(), parent.end(), std::size_t{0});
    const auto representative = [&](std::size_t i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    };
    for (std::size_t node = firstFree; node < poses_.size(); ++node)
        for (const std::size_t i : edgesUpTo_[node])
            parent[representative(numberOf(edges_[i].from))] =
                representative(numberOf(edges_[i].to));
    for (std::size_t node = firstFree; node < poses_.size(); ++node)
        if (representative(numberOf(node)) != representative(0))
            throw Error("pose graph: no path of edges connects node " + std::to_string(node) +
                        " to node 0");
}

WhitenedGraph PoseGraph::whitened(std::size_t firstFree, const std::vector<bool>& doubtful) const {
    WhitenedGraph graph;
    graph.firstNode = firstFree;
    for (std::size_t node = firstFree; node < poses_.size(); ++node)
        for (const std::size_t i : edgesUpTo_[node])
            graph.firstNode = std::min({graph.firstNode, edges_[i].from, edges_[i].to});
    for (std::size_t node = firstFree; node < poses_.size(); ++node) {
        graph.free.insert(graph.free.end(), node - graph.firstNode);
        graph.nodes[node - graph.firstNode] = toMrpt(poses_[node]);
        for (const std::size_t i : edgesUpTo_[node]) {
            const Edge& edge = edges_[i];
            mrpt::poses::CPose3DPDFGaussianInf measured(toMrpt(edge.increment.pose));
            const Matrix6 U = information(i).llt().matrixU();
            measured.cov_inv.asEigen() = U;
            const auto entry = graph.edges.emplace(
                std::make_pair(edge.from - graph.firstNode, edge.to - graph.firstNode), measured);
            if (!doubtful.empty() && doubtful[i]) graph.doubtful.insert(&*entry);
            for (const std::size_t end : {edge.from, edge.to})
                graph.nodes[end - graph.firstNode] = toMrpt(poses_[end]);
        }
    }
    return graph;
}

void PoseGraph::takeFreePoses(const WhitenedGraph& graph) {
    for (const auto node : graph.free)
        poses_[node + graph.firstNode] = fromMrpt(graph.nodes.at(node));
}

OptimisationResult PoseGraph::optimise(const PoseGraphOptions& options) {
    if (poses_.empty()) throw Error("pose graph: no nodes");
    requireConnected(1);
    const double c = options.kernel_width;
    auto graph = whitened(1, c > 0 ? doubtfulEdges(*this, c) : std::vector<bool>{});
    graph.kernelWidth = graph.doubtfulWidth = c;
    const double initialCost = costOf(graph);
    const auto start = graph.nodes;

    OptimisationResult result;
    const auto run = [&](double width, unsigned limit) {
        graph.kernelWidth = width;
        const unsigned before = result.iterations;
        result = minimise(graph, std::min(options.max_iterations - before, limit));
        result.iterations += before;
    };
    // Graduated non-convexity (Yang et al., 2020): a kernel that is narrow from the start leaves
    // out each edge that the start is far from, right or wrong. So the first round has none, and
    // those that follow narrow it from the largest error down to c. Edges that contradict the chain
    // would bend it before they are left out; they have the narrow kernel in every round.
    if (c > 0 && largestError(graph) > c) {
        constexpr unsigned kStepsOfRound = 5;  // only the last round has to converge
        run(0, options.max_iterations);
        for (double width = largestError(graph); width > c; width /= 2) run(width, kStepsOfRound);
    }
    run(c, options.max_iterations);
    if (result.final_cost > initialCost) {
        graph.nodes = start;
        run(c, options.max_iterations);
    }
    result.initial_cost = initialCost;
    takeFreePoses(graph);
    return result;
}

OptimisationResult PoseGraph::optimiseLast(std::size_t count, const PoseGraphOptions& options) {
    if (poses_.empty()) throw Error("pose graph: no nodes");
    const std::size_t firstFree = poses_.size() - std::min(count, poses_.size() - 1);
    requireConnected(firstFree);
    auto graph = whitened(firstFree, {});
    graph.kernelWidth = options.kernel_width;
    const auto result = minimise(graph, options.max_iterations);
    takeFreePoses(graph);
    return result;
}

mrpt::poses::CPose3DPDFGaussian posePdfOf(const Increment& increment) {
    const auto inverseOf = [](const Matrix6& m) {
        const Matrix6 inverse = m.ldlt().solve(Matrix6::Identity());
        return Matrix6((inverse + inverse.transpose()) / 2);
    };
    mrpt::poses::CPose3DPDFGaussian pdf(toMrpt(increment.pose));
    pdf.cov.asEigen() =
        inverseOf(convertInformation(inverseOf(increment.covariance), increment.pose,
                                     InformationOf::tangent, InformationOf::yawPitchRoll));
    return pdf;
}
}  // namespace delio::graph
