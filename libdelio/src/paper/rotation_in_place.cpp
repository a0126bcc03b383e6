#include "paper/rotation_in_place.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/kd_tree.h"
#include "core/portable_math.h"
#include "core/principal_axes.h"
#include "delio/core/geometry.h"
#include "paper/weighted_directions.h"

namespace delio::paper {
namespace {
constexpr double kDeg = M_PI / 180;

/** Of each normal of `to`, those of `from` within two standard deviations of its place. */
using Partners = std::vector<WeightedDirections>;

Partners partnersInPlace(const Pattern& from, const Pattern& to, const Eigen::Isometry3d& pose,
                         double sigma) {
    const KdTree tree(from.points);
    const auto reach = static_cast<float>(4 * sigma * sigma);
    const auto scale = static_cast<float>(-0.5 / (sigma * sigma));
    const Eigen::Isometry3f moved = pose.cast<float>();
    Partners partners(static_cast<std::size_t>(to.points.cols()));
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, partners.size(), 64),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          std::vector<std::pair<std::uint32_t, float>> near;
                          for (std::size_t k = range.begin(); k != range.end(); ++k) {
                              const auto i = static_cast<Eigen::Index>(k);
                              tree.within(moved * to.points.col(i), reach, near);
                              for (const auto& [index, squared] : near)
                                  partners[k].add(from.directions.col(index),
                                                  from.weights[index] * to.weights[i] *
                                                      portable::exp(scale * squared));
                          }
                      });
    return partners;
}

std::size_t countOf(const Partners& partners) {
    std::size_t count = 0;
    for (const auto& some : partners) count += some.size();
    return count;
}

struct Moment {
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
    double weight = 0, squaredAngles = 0;
};

Moment operator+(const Moment& a, const Moment& b) {
    return {a.moment + b.moment, a.weight + b.weight, a.squaredAngles + b.squaredAngles};
}

/** Of all pairs, weighted by how well they agree. */
Moment momentOf(const Pattern& to, const Partners& partners, const Eigen::Matrix3d& R,
                double kernel_rad) {
    constexpr double kAny = 5;  // no chord is longer
    // The same bytes for any number of threads: this way of splitting and adding is a fixed one.
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, partners.size(), 256), Moment(),
        [&](const tbb::blocked_range<std::size_t>& range, Moment sum) {
            for (std::size_t k = range.begin(); k != range.end(); ++k) {
                const Eigen::Vector3f own = to.directions.col(static_cast<Eigen::Index>(k)),
                                      turned = R.cast<float>() * own;
                const auto found = partners[k].under(turned, kernel_rad, kAny);
                sum.moment += found.directions.cast<double>() * own.cast<double>().transpose();
                sum.weight += double{found.weight};
                sum.squaredAngles += double{found.squares};
            }
            return sum;
        },
        [](const Moment& a, const Moment& b) { return a + b; });
}

/** `rotation` without what it turned about the axes that the pattern leaves open. */
Eigen::Matrix3d keepOpenAxes(const RotationEstimate& found, const Eigen::Matrix3d& rotation) {
    if (found.unobservedAxes.cols() == 0) return rotation;
    Eigen::Vector3d correction = rotationLog(found.rotation.transpose() * rotation);
    for (Eigen::Index k = 0; k < found.unobservedAxes.cols(); ++k)
        correction -= found.unobservedAxes.col(k) * found.unobservedAxes.col(k).dot(correction);
    return found.rotation * rotationExp(correction);
}
}  // namespace

RotationEstimate registerInPlace(const Pattern& from, const Pattern& to,
                                 const RotationEstimate& found, const Eigen::Vector3d& translation,
                                 const RotationInPlaceOptions& options) {
    if (from.points.cols() == 0 || to.points.cols() == 0) return found;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = found.rotation;
    pose.translation() = translation;
    const auto partners = partnersInPlace(from, to, pose, options.place_sigma);
    const std::size_t pairs = countOf(partners);
    if (pairs < options.min_pairs) return found;
    RotationEstimate estimate = found;
    unsigned iterations = 0;
    for (double kernel_deg = options.kernel_deg;; kernel_deg /= 2) {
        kernel_deg = std::max(kernel_deg, options.last_kernel_deg);
        double step = M_PI;
        while (iterations < options.max_iterations && step > options.converged_deg * kDeg) {
            const Moment sum = momentOf(to, partners, estimate.rotation, kernel_deg * kDeg);
            if (!(sum.weight > 0)) return found;
            const Eigen::Matrix3d next = rotationOf(sum.moment);
            step = angleOf(estimate.rotation.transpose() * next);
            estimate.rotation = next;
            estimate.residual_rad = std::sqrt(sum.squaredAngles / sum.weight);
            ++iterations;
        }
        estimate.converged = step <= options.converged_deg * kDeg;
        if (kernel_deg <= options.last_kernel_deg) break;
    }
    estimate.iterations += iterations;
    estimate.matches = pairs;
    estimate.rotation = keepOpenAxes(found, estimate.rotation);
    return estimate;
}
}  // namespace delio::paper
