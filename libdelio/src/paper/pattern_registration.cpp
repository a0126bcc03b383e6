#include "paper/pattern_registration.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/kd_tree.h"
#include "core/portable_math.h"
#include "core/principal_axes.h"
#include "core/voxel_grid.h"
#include "delio/core/geometry.h"
#include "paper/weighted_directions.h"

namespace delio::paper {
namespace {
constexpr double kDeg = M_PI / 180;
constexpr Eigen::Index kBlock = 128;
constexpr double kReach = 2.5;  // of the kernel, in standard deviations

/** Pairs are never taken to fit better than this: the same scan twice leaves no residual at all,
 * but a covariance has to be one. */
constexpr double kLeastResidual_rad = 0.01 * kDeg;

/** What pairing gives: the sum of w n_from n_to' that SVD wants, and what the residual wants. */
struct Pairing {
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
    double weight = 0;
    double squaredAngles = 0;
    std::size_t matches = 0;
    double matched = 0;  //!< weight of `to` that has a partner
};

/** Sums over the normals of `to`. They are made per block of fixed size and added in order: the
 *  same bytes for any number of threads. */
template <typename PairOne>
Pairing pairAll(Eigen::Index count, const PairOne& pairOne) {
    std::vector<Pairing> blocks(static_cast<std::size_t>((count + kBlock - 1) / kBlock));
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
        const Eigen::Index begin = static_cast<Eigen::Index>(b) * kBlock;
        for (Eigen::Index i = begin; i < std::min(count, begin + kBlock); ++i)
            pairOne(i, blocks[b]);
    });
    Pairing total;
    for (const auto& block : blocks) {
        total.moment += block.moment;
        total.weight += block.weight;
        total.squaredAngles += block.squaredAngles;
        total.matches += block.matches;
        total.matched += block.matched;
    }
    return total;
}

Pairing pairNearest(const Pattern& from, const KdTree& tree, const Pattern& to,
                    const Eigen::Matrix3d& R) {
    return pairAll(to.directions.cols(), [&](Eigen::Index i, Pairing& sum) {
        const Eigen::Vector3f turned = R.cast<float>() * to.directions.col(i);
        std::uint32_t index = 0;
        float squared = 0;
        if (tree.nearest(turned, 1, &index, &squared) == 0) return;
        const Eigen::Vector3d partner = from.directions.col(index).cast<double>();
        sum.moment += partner * to.directions.col(i).cast<double>().transpose();
        sum.weight += 1;
        sum.squaredAngles += static_cast<double>(squared);
        ++sum.matches;
        sum.matched += static_cast<double>(to.weights[i]);
    });
}

/** Which normals of `from` may be partners of each one of `to`: the tree is asked again only when
 *  the rotation has turned so far that others may have come near. */
class Neighbours {
 public:
    /** Partners are at most `reach` apart on the unit sphere. */
    Neighbours(const Pattern& from, const Pattern& to, double reach)
        : from_(from),
          to_(to),
          tree_(from.directions),
          reach_(reach),
          of_(static_cast<std::size_t>(to.directions.cols())) {}

    /** Of each normal of `to`, turned by R; some lie a bit farther away. */
    const std::vector<WeightedDirections>& at(const Eigen::Matrix3d& R) {
        constexpr double kSpare = 0.15;
        const double spare = kSpare * reach_;
        if (asked_ && angleOf(R.transpose() * *asked_) < spare) return of_;
        asked_ = R;
        const auto squared = static_cast<float>((reach_ + spare) * (reach_ + spare));
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, of_.size(), kBlock), [&](const auto& block) {
                std::vector<std::pair<std::uint32_t, float>> near;
                for (std::size_t i = block.begin(); i != block.end(); ++i) {
                    const auto column = static_cast<Eigen::Index>(i);
                    tree_.within(R.cast<float>() * to_.directions.col(column), squared, near);
                    of_[i].clear();
                    for (const auto& [number, distance] : near)
                        of_[i].add(from_.directions.col(number), from_.weights[number]);
                }
            });
        return of_;
    }

 private:
    const Pattern &from_, &to_;
    const KdTree tree_;
    const double reach_;
    std::vector<WeightedDirections> of_;
    std::optional<Eigen::Matrix3d> asked_;
};

/** Pairs each normal with all of the other pattern within 2.5 sigma. The sum of the pairs' weights
 *  is the correlation of the two densities; its maximum is where pairing and SVD stand still. */
Pairing pairDensities(const std::vector<WeightedDirections>& neighbours, const Pattern& to,
                      const Eigen::Matrix3d& R, double sigma_rad) {
    const double reach_rad = kReach * sigma_rad;
    return pairAll(to.directions.cols(), [&](Eigen::Index i, Pairing& sum) {
        const Eigen::Vector3f turned = R.cast<float>() * to.directions.col(i);
        const auto partners =
            neighbours[static_cast<std::size_t>(i)].under(turned, sigma_rad, reach_rad * reach_rad);
        const float weight = partners.weight;
        if (!(weight > 0)) return;
        const double own = to.weights[i];
        sum.moment += own * partners.directions.cast<double>() *
                      to.directions.col(i).cast<double>().transpose();
        sum.weight += own * static_cast<double>(weight);
        sum.squaredAngles +=
            own *
            static_cast<double>(weight * (partners.directions / weight - turned).squaredNorm());
        ++sum.matches;
        sum.matched += own;
    });
}

/** Fewer directions that stand for the pattern: the weighted centroid of each cell. Cells a quarter
 *  as wide as the kernel change the correlation by about 1 %. */
Pattern condensed(const Pattern& pattern, double kernel_deg,
                  const PatternRegistrationOptions& options) {
    const double cell_deg = std::max(options.cell_deg, kernel_deg / 4);
    const auto cells = numberVoxels(pattern.directions, cell_deg * kDeg);
    Pattern result;
    result.normals = pattern.normals;
    result.directions = sumsOf<3>(pattern.directions * pattern.weights.asDiagonal(), cells).sums;
    result.weights = sumsOf<1>(pattern.weights.transpose(), cells).sums.transpose();
    result.directions.colwise().normalize();
    return result;
}

/** Pairs, by `pairAt(rotation)`, and turns until the rotation stands still. Not valid where too few
 *  normals of `to` find a partner. */
template <typename PairAt>
void iterate(const Pattern& to, const PatternRegistrationOptions& options, const PairAt& pairAt,
             RotationEstimate& estimate) {
    // The weight that stands for min_normals, less what rounding takes.
    const double enough = (1 - 1e-6) * options.min_normals * static_cast<double>(to.weights.sum()) /
                          static_cast<double>(to.normals);
    double step = M_PI;
    estimate.converged = false;
    while (estimate.iterations < options.max_iterations && step > options.converged_deg * kDeg) {
        const Pairing pairs = pairAt(estimate.rotation);
        estimate.valid = pairs.matched >= enough;
        if (!estimate.valid) return;
        ++estimate.iterations;
        estimate.matches = pairs.matches;
        estimate.residual_rad = std::sqrt(pairs.squaredAngles / pairs.weight);
        const Eigen::Matrix3d next = rotationOf(pairs.moment);
        step = angleOf(estimate.rotation.transpose() * next);
        estimate.rotation = next;
    }
    estimate.converged = step <= options.converged_deg * kDeg;
}

void correlate(const Pattern& from, const Pattern& to, double sigma_rad,
               const PatternRegistrationOptions& options, RotationEstimate& estimate) {
    Neighbours neighbours(from, to, kReach * sigma_rad);
    iterate(
        to, options,
        [&](const Eigen::Matrix3d& R) { return pairDensities(neighbours.at(R), to, R, sigma_rad); },
        estimate);
}

void matchNearest(const Pattern& from, const Pattern& to, const PatternRegistrationOptions& options,
                  RotationEstimate& estimate) {
    const KdTree tree(from.directions);
    iterate(
        to, options, [&](const Eigen::Matrix3d& R) { return pairNearest(from, tree, to, R); },
        estimate);
}

/** Moves the estimate back to the prediction about the axes that the pattern does not fix, or about
 *  all where it is not valid, and gives the covariance: noise over geometry on the others, the
 *  motion model's on those. */
void settle(const Pattern& to, const Eigen::Matrix3d& predicted,
            const PatternRegistrationOptions& options, RotationEstimate& estimate) {
    const double prior = options.prior_sigma_deg * kDeg * options.prior_sigma_deg * kDeg;
    if (!estimate.valid) {
        estimate.rotation = predicted;
        estimate.covariance = prior * Eigen::Matrix3d::Identity();
        estimate.unobservedAxes = Eigen::Matrix3d::Identity();
        return;
    }
    const auto axes = axesOf(to);
    estimate.observability = axes.eigenvalues();
    const double residual = std::max(estimate.residual_rad, kLeastResidual_rad);
    // A kernel that is narrower than the spread of normals on a surface cuts the residual.
    constexpr double kSpread_deg = 0.7;
    const double cut =
        options.kernel_deg > 0 ? std::min(1.0, options.last_kernel_deg / kSpread_deg) : 1;
    const double share = cut * cut * options.independent_share;
    const double noise = residual * residual / (share * static_cast<double>(to.normals));

    Eigen::Vector3d correction = rotationLog(predicted.transpose() * estimate.rotation);
    for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d axis = axes.eigenvectors().col(k);
        const bool observed = axes.eigenvalues()[k] >= options.min_observability;
        if (!observed) {
            correction -= axis.dot(correction) * axis;
            estimate.unobservedAxes.conservativeResize(3, estimate.unobservedAxes.cols() + 1);
            estimate.unobservedAxes.rightCols<1>() = axis;
        }
        estimate.covariance +=
            (observed ? noise / axes.eigenvalues()[k] : prior) * axis * axis.transpose();
    }
    if (estimate.unobservedAxes.cols() == 0) return;
    estimate.rotation = predicted * rotationExp(correction);
}
}  // namespace

void weighGround(Pattern& pattern, const Eigen::Vector3f& up,
                 const PatternRegistrationOptions& options) {
    const auto cosine = static_cast<float>(portable::cos(options.ground_deg * kDeg));
    const auto weight = static_cast<float>(options.ground_weight);
    for (Eigen::Index i = 0; i < pattern.directions.cols(); ++i)
        if (std::abs(up.dot(pattern.directions.col(i))) > cosine) pattern.weights[i] *= weight;
}

RotationEstimate registerPatterns(const Pattern& from, const Pattern& to,
                                  const Eigen::Matrix3d& predicted,
                                  const PatternRegistrationOptions& options) {
    RotationEstimate estimate;
    estimate.rotation = predicted;
    const bool enough = std::min(from.normals, to.normals) >= options.min_normals;
    if (enough && options.kernel_deg > 0) {
        estimate.valid = true;
        for (double kernel_deg = options.kernel_deg; estimate.valid; kernel_deg /= 2) {
            kernel_deg = std::max(kernel_deg, options.last_kernel_deg);
            correlate(condensed(from, kernel_deg, options), condensed(to, kernel_deg, options),
                      kernel_deg * kDeg, options, estimate);
            if (kernel_deg <= options.last_kernel_deg) break;
        }
    } else if (enough)
        matchNearest(from, to, options, estimate);
    const double correction = angleOf(predicted.transpose() * estimate.rotation);
    if (correction > options.max_correction_deg * kDeg) {
        estimate.tooFar = true;
        estimate.valid = false;
    }
    settle(to, predicted, options, estimate);
    return estimate;
}
}  // namespace delio::paper
