#include "delio/graph/pose_graph.h"

#include <Eigen/Cholesky>
#include <string>

#include "delio/error.h"
#include "levmarq_seam.h"

namespace delio::graph {
using mrpt::poses::CPose3D;

namespace {
bool isFinite(const CPose3D& pose) {
    return pose.getRotationMatrix().asEigen().allFinite() && pose.m_coords.asEigen().allFinite();
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

std::vector<OptionField> PoseGraphOptions::fields() {
    return {
        {"skip_edges", &skip_edges,
         "edges beyond the chain: 1 adds (i,i+2), 2 also (i,i+3), 0 none", 0, 100},
        {"max_iterations", &max_iterations, "limit of Levenberg-Marquardt steps", 1, 100000},
        {"kernel_width", &kernel_width,
         "width of the Geman-McClure kernel in standard deviations; 0: no robust kernel", 0, 1e9}};
}

std::size_t PoseGraph::addNode(const CPose3D& initial) {
    if (!isFinite(initial))
        throw Error("pose graph: the pose of node " + std::to_string(poses_.size()) +
                    " is not finite");
    poses_.push_back(initial);
    return poses_.size() - 1;
}

void PoseGraph::addEdge(const Edge& edge) {
    const Matrix6 covariance = edge.increment.covariance.asEigen();
    if (!isPositiveDefinite(covariance))
        throw Error("pose graph: the covariance of " + nameOf(edge.from, edge.to) +
                    " is not symmetric and positive definite");
    append(edge, inverseOf(covariance));
}

void PoseGraph::addEdge(std::size_t from, std::size_t to, const CPose3D& pose,
                        const Matrix6& information) {
    if (!isPositiveDefinite(information))
        throw Error("pose graph: the information of " + nameOf(from, to) +
                    " is not symmetric and positive definite");
    Edge edge{from, to, {pose, {}}};
    edge.increment.covariance.asEigen() = inverseOf(information);
    append(edge, information);
}

void PoseGraph::append(const Edge& edge, const Matrix6& information) {
    const std::string name = nameOf(edge.from, edge.to);
    if (edge.from >= poses_.size() || edge.to >= poses_.size())
        throw Error("pose graph: " + name + " needs nodes that are not there (there are " +
                    std::to_string(poses_.size()) + ")");
    if (edge.from == edge.to) throw Error("pose graph: " + name + " goes from a node to itself");
    if (!isFinite(edge.increment.pose)) throw Error("pose graph: " + name + " is not finite");
    // Finite too: a covariance of 1e-320 has no inverse in doubles.
    if (!isPositiveDefinite(information))
        throw Error("pose graph: the covariance of " + name + " cannot be inverted");
    edges_.push_back(edge);
    information_.push_back(information);
}

void PoseGraph::requireConnected() const {
    std::vector<std::vector<std::size_t>> neighbours(poses_.size());
    for (const auto& edge : edges_) {
        neighbours[edge.from].push_back(edge.to);
        neighbours[edge.to].push_back(edge.from);
    }
    std::vector<bool> reached(poses_.size(), false);
    std::vector<std::size_t> open{0};
    reached[0] = true;
    while (!open.empty()) {
        const std::size_t node = open.back();
        open.pop_back();
        for (const std::size_t next : neighbours[node]) {
            if (reached[next]) continue;
            reached[next] = true;
            open.push_back(next);
        }
    }
    for (std::size_t node = 0; node < reached.size(); ++node)
        if (!reached[node])
            throw Error("pose graph: no edges connect node " + std::to_string(node) + " to node 0");
}

OptimisationResult PoseGraph::optimise(const PoseGraphOptions& options) {
    if (poses_.empty()) throw Error("pose graph: there are no nodes");
    requireConnected();

    WhitenedGraph graph;
    graph.root = 0;
    graph.kernelWidth = options.kernel_width;
    for (std::size_t i = 0; i < poses_.size(); ++i) graph.nodes[i] = poses_[i];
    for (std::size_t i = 0; i < edges_.size(); ++i) {
        mrpt::poses::CPose3DPDFGaussianInf measured(edges_[i].increment.pose);
        const Matrix6 U = information_[i].llt().matrixU();
        measured.cov_inv.asEigen() = U;
        graph.insertEdge(edges_[i].from, edges_[i].to, measured);
    }
    const auto result = minimise(graph, options.max_iterations);
    for (std::size_t i = 0; i < poses_.size(); ++i) poses_[i] = graph.nodes.at(i);
    return result;
}
}  // namespace delio::graph
