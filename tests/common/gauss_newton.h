#pragma once
#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <vector>

#include "delio/graph/pose_graph.h"

namespace delio::test {
/** Pose graphs the plainest way, to check the library by: Eigen's isometries, central differences
 *  in place of Jacobians, undamped Gauss-Newton. Shares no code with the library. */
using Poses = std::vector<Eigen::Isometry3d>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/** T * (exp(w), t) for e = [t w]. */
inline Eigen::Isometry3d moved(const Eigen::Isometry3d& T, const Vector6d& e) {
    Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
    const double angle = e.tail<3>().norm();
    if (angle > 0) step.linear() = Eigen::AngleAxisd(angle, e.tail<3>() / angle).matrix();
    step.translation() = e.head<3>();
    return T * step;
}

inline Vector6d errorOf(const Eigen::Isometry3d& Z, const Eigen::Isometry3d& from,
                        const Eigen::Isometry3d& to) {
    const Eigen::Isometry3d E = Z.inverse() * from.inverse() * to;
    Eigen::Quaterniond q(E.linear());
    if (q.w() < 0) q.coeffs() *= -1;
    const double s = q.vec().norm();
    Vector6d e;
    e << E.translation(), (s > 1e-12 ? 2 * std::atan2(s, q.w()) / s : 2.0) * q.vec();
    return e;
}

/** e' Omega e under the Geman-McClure kernel. */
inline double edgeCost(const Vector6d& e, const Eigen::Matrix<double, 6, 6>& information,
                       double kernelWidth) {
    const double s = e.dot(information * e);
    return kernelWidth == 0 ? s : s / (1 + s / (kernelWidth * kernelWidth));
}

inline double costOf(const graph::PoseGraph& graph, const Poses& poses, double kernelWidth = 0) {
    double cost = 0;
    for (std::size_t i = 0; i < graph.edges().size(); ++i) {
        const auto& edge = graph.edges()[i];
        cost += edgeCost(errorOf(edge.increment.pose, poses[edge.from], poses[edge.to]),
                         graph.information(i), kernelWidth);
    }
    return cost;
}

/** d cost / d (every node's right tangent), by differences. */
inline Eigen::VectorXd gradientOf(const graph::PoseGraph& graph, const Poses& poses,
                                  double kernelWidth) {
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(6 * static_cast<Eigen::Index>(poses.size()));
    const double h = 1e-6;
    for (std::size_t i = 0; i < graph.edges().size(); ++i) {
        const auto& edge = graph.edges()[i];
        const auto& Z = edge.increment.pose;
        for (int k = 0; k < 6; ++k) {
            const auto slope = [&](const auto& error) {
                const Vector6d step = h * Vector6d::Unit(k);
                return (edgeCost(error(step), graph.information(i), kernelWidth) -
                        edgeCost(error(-step), graph.information(i), kernelWidth)) /
                       (2 * h);
            };
            gradient[6 * static_cast<Eigen::Index>(edge.from) + k] += slope([&](const Vector6d& e) {
                return errorOf(Z, moved(poses[edge.from], e), poses[edge.to]);
            });
            gradient[6 * static_cast<Eigen::Index>(edge.to) + k] += slope([&](const Vector6d& e) {
                return errorOf(Z, poses[edge.from], moved(poses[edge.to], e));
            });
        }
    }
    return gradient;
}

/** `steps` undamped Gauss-Newton steps without a kernel; node 0 stays. */
inline Poses gaussNewton(const graph::PoseGraph& graph, int steps) {
    Poses poses = graph.poses();
    const auto size = 6 * static_cast<Eigen::Index>(poses.size() - 1);
    const double h = 1e-6;
    for (int step = 0; step < steps; ++step) {
        std::vector<Eigen::Triplet<double>> entries;
        Eigen::VectorXd b = Eigen::VectorXd::Zero(size);
        for (std::size_t i = 0; i < graph.edges().size(); ++i) {
            const auto& edge = graph.edges()[i];
            const auto& Z = edge.increment.pose;
            const auto& from = poses[edge.from];
            const auto& to = poses[edge.to];
            Eigen::Matrix<double, 6, 12> J;
            for (int k = 0; k < 6; ++k) {
                const Vector6d d = h * Vector6d::Unit(k);
                J.col(k) =
                    (errorOf(Z, moved(from, d), to) - errorOf(Z, moved(from, -d), to)) / (2 * h);
                J.col(6 + k) =
                    (errorOf(Z, from, moved(to, d)) - errorOf(Z, from, moved(to, -d))) / (2 * h);
            }
            const Eigen::Matrix<double, 12, 12> H = J.transpose() * graph.information(i) * J;
            const Eigen::Matrix<double, 12, 1> g =
                J.transpose() * (graph.information(i) * errorOf(Z, from, to));
            // Rows of node 0 are negative, and left out.
            const auto row = [&](int k) {
                return 6 * static_cast<Eigen::Index>(k < 6 ? edge.from : edge.to) - 6 + k % 6;
            };
            for (int r = 0; r < 12; ++r) {
                if (row(r) < 0) continue;
                b[row(r)] += g[r];
                for (int c = 0; c < 12; ++c)
                    if (row(c) >= 0)
                        entries.emplace_back(static_cast<int>(row(r)), static_cast<int>(row(c)),
                                             H(r, c));
            }
        }
        Eigen::SparseMatrix<double> H(size, size);
        H.setFromTriplets(entries.begin(), entries.end());
        const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(H);
        const Eigen::VectorXd delta = solver.solve(b);
        for (std::size_t i = 1; i < poses.size(); ++i)
            poses[i] = moved(poses[i], -delta.segment<6>(6 * static_cast<Eigen::Index>(i) - 6));
    }
    return poses;
}
}  // namespace delio::test
