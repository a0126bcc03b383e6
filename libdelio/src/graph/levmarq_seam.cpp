#include "graph/levmarq_seam.h"

#include "graph/residual.h"

#include <mrpt/graphslam/levmarq.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace delio::graph {
namespace {
/** rho(s) = s / (1 + s/c^2), Geman and McClure's kernel on a squared error s, and its slope. */
struct Kernel {
    double cost, slope;
};

Kernel kernelAt(double s, double width) {
    if (width == 0) return {s, 1};
    const double w = 1 / (1 + s / (width * width));
    return {s * w, w * w};
}
}  // namespace
}  // namespace delio::graph

namespace mrpt::graphslam {
using delio::graph::WhitenedGraph;
using WhitenedTraits = graphslam_traits<WhitenedGraph>;

/** Errors and Jacobians come whitened, so the information has no part in these products. */
template <>
struct detail::AuxErrorEval<mrpt::poses::CPose3DPDFGaussianInf, WhitenedTraits> {
    using Edge = WhitenedTraits::edge_map_entry_t;
    using Matrix = WhitenedTraits::matrix_TxT;
    using Vector = WhitenedTraits::Array_O;

    static void multiplyJtLambdaJ(const Matrix& J, Matrix& out, const Edge*) {
        out.asEigen() = J.asEigen().transpose() * J.asEigen();
    }
    static void multiplyJ1tLambdaJ2(const Matrix& J1, const Matrix& J2, Matrix& out, const Edge*) {
        out.asEigen() = J1.asEigen().transpose() * J2.asEigen();
    }
    static void multiply_Jt_W_err(const Matrix& J, const Edge*, const Vector& error, Vector& out) {
        out.asEigen() = J.asEigen().transpose() * error.asEigen();
    }
};

/** Returns the robust cost, by which MRPT accepts or rejects a step, and sqrt(rho'(s)) U e with
 *  its Jacobians: J'J and J'e then are the Gauss-Newton Hessian and the gradient of that cost. */
template <>
double computeJacobiansAndErrors<WhitenedGraph>(
    const WhitenedGraph& graph, const std::vector<WhitenedTraits::observation_info_t>& observations,
    WhitenedTraits::map_pairIDs_pairJacobs_t& jacobians,
    std::vector<WhitenedTraits::Array_O>& errors) {
    jacobians.clear();
    errors.clear();
    errors.reserve(observations.size());
    double cost = 0;
    for (const auto& observation : observations) {
        const auto r = delio::graph::residualOf(delio::fromMrpt(*observation.edge_mean),
                                                delio::fromMrpt(*observation.P1),
                                                delio::fromMrpt(*observation.P2));
        const delio::Matrix6 U = observation.edge->second.cov_inv.asEigen();
        const delio::Vector6 whitened = U * r.error;
        const auto kernel =
            delio::graph::kernelAt(whitened.squaredNorm(), graph.widthOf(*observation.edge));
        const double weight = std::sqrt(kernel.slope);
        cost += kernel.cost;
        errors.emplace_back((weight * whitened).eval());
        const auto entry = jacobians.emplace_hint(jacobians.end(), observation.edge->first,
                                                  WhitenedTraits::TPairJacobs());
        entry->second.first.asEigen() = weight * U * r.dFrom;
        entry->second.second.asEigen() = weight * U * r.dTo;
    }
    return cost;
}
}  // namespace mrpt::graphslam

namespace delio::graph {
namespace {
double squaredError(const WhitenedGraph& graph, const WhitenedGraph::MapEntry& edge) {
    const auto& [ids, measured] = edge;
    const auto r = residualOf(fromMrpt(measured.mean), fromMrpt(graph.nodes.at(ids.first)),
                              fromMrpt(graph.nodes.at(ids.second)));
    return (measured.cov_inv.asEigen() * r.error).squaredNorm();
}
}  // namespace

double costOf(const WhitenedGraph& graph) {
    double cost = 0;
    for (const auto& edge : graph.edges)
        cost += kernelAt(squaredError(graph, edge), graph.widthOf(edge)).cost;
    return cost;
}

double largestError(const WhitenedGraph& graph) {
    double largest = 0;
    for (const auto& edge : graph.edges)
        if (graph.doubtful.count(&edge) == 0)
            largest = std::max(largest, squaredError(graph, edge));
    return std::sqrt(largest);
}

OptimisationResult minimise(WhitenedGraph& graph, unsigned maxIterations) {
    OptimisationResult result;
    result.initial_cost = result.final_cost = costOf(graph);
    result.converged = graph.edges.empty() || graph.free.empty();
    // MRPT damps by lambda = tau * (largest diagonal entry of the Hessian), a tenth of it after
    // every step that it accepts. The Hessian's eigenvalues fall with the fourth power of a
    // chain's length (1e-14 of the largest at 4500 nodes), so the start is all but undamped.
    double tau = 1e-18;
    double raise = 10;
    while (!result.converged && result.iterations < maxIterations) {
        double cost = std::numeric_limits<double>::infinity();
        bool rejected = false;
        bool settled = false;
        // Called at the start of each of MRPT's iterations.
        const mrpt::graphslam::graphslam_traits<WhitenedGraph>::TFunctorFeedback watch =
            [&](const WhitenedGraph&, std::size_t iteration, std::size_t, double now) {
                rejected = !(now < cost);
                if (rejected) return;
                ++result.iterations;
                if (iteration > 0) {
                    settled = cost - now <= 1e-9 * now;
                    tau /= 10;
                    raise = 10;
                }
                cost = now;
            };
        mrpt::containers::yaml parameters;
        parameters["tau"] = tau;
        parameters["max_iterations"] = maxIterations - result.iterations;
        parameters["e1"] = 1e-6;   // of the gradient's largest entry
        parameters["e2"] = 1e-10;  // of the step's length, relative to that of all poses
        try {
            mrpt::graphslam::TResultInfoSpaLevMarq info{};
            mrpt::graphslam::optimize_graph_spa_levmarq(graph, info, &graph.free, parameters,
                                                        watch);
            result.converged = !rejected && result.iterations < maxIterations;
        } catch (const std::exception&) {
            if (!rejected) throw;
        }
        // MRPT 2.5.8 loses the Hessian when it rejects a step, and gets no further (it raises
        // lambda over empty matrices, then gives up): begin again where it stood, damped more.
        if (rejected) {
            tau = std::max(tau, 1e-18) * raise;
            raise *= 10;
            result.converged = settled || tau > 1e6;  // no step goes down, however short
        }
    }
    result.final_cost = costOf(graph);
    return result;
}
}  // namespace delio::graph
