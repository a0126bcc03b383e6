#include "paper/line_registration.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/portable_math.h"

namespace delio::paper {
LineMatcher::LineMatcher(const LineCloud& from) : from_(from), tree_(from.midpoints) {}

LineMatcher::Found LineMatcher::find(const Eigen::Vector3f& at) const {
    Found found;
    found.at = at;
    std::array<float, Found::kMost> squared{};
    found.count = tree_.nearest(at, Found::kMost, found.nearest.data(), squared.data());
    found.others_m = found.count == Found::kMost ? std::sqrt(squared.back())
                                                 : std::numeric_limits<float>::infinity();
    return found;
}

Match LineMatcher::nearestOf(const Found& found, const Eigen::Vector3f& at) const {
    Match best;
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < found.count; ++i) {
        const std::uint32_t from = found.nearest[i];
        const float squared =
            (from_.midpoints.col(static_cast<Eigen::Index>(from)) - at).squaredNorm();
        if (squared >= least) continue;
        least = squared;
        best.from = from;
    }
    best.distance = std::sqrt(least);
    return best;
}

std::vector<Match> LineMatcher::matches(const LineCloud& to, const Eigen::Vector3d& t,
                                        double farthest) {
    const auto count = static_cast<std::size_t>(to.midpoints.cols());
    std::vector<Match> matches(count);
    if (from_.midpoints.cols() == 0) return matches;
    found_.resize(count);
    const Eigen::Vector3f moved = t.cast<float>();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 128),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i != range.end(); ++i) {
                              Found& found = found_[i];
                              const Eigen::Vector3f at =
                                  to.midpoints.col(static_cast<Eigen::Index>(i)) + moved;
                              Match nearest = nearestOf(found, at);
                              if (!(nearest.distance + (at - found.at).norm() < found.others_m)) {
                                  found = find(at);
                                  nearest = nearestOf(found, at);
                              }
                              if (nearest.distance <= static_cast<float>(farthest))
                                  matches[i] = nearest;
                          }
                      });
    return matches;
}

double meanDistance(const std::vector<Match>& matches) {
    double distances = 0, count = 0;
    for (const auto& match : matches)
        if (match.distance >= 0) {
            distances += static_cast<double>(match.distance);
            count += 1;
        }
    return distances / std::max(count, 1.0);
}

namespace {
/** Lines are never taken to lie nearer to each other than this: the same scan twice leaves no
 *  residual at all, but a covariance has to be one. */
constexpr double kLeastResidual_m = 1e-3;

/** Which directions are seen is judged where the iteration ends; on the way there, where pairs are
 *  still wrong, so many times less will do. */
constexpr double kPatience = 16;

/** Of all pairs' closest points: d = X_from - X_to, and the projection onto what the pair sees. */
struct Sums {
    Eigen::Vector3d d = Eigen::Vector3d::Zero();
    Eigen::Matrix3d seen = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d lever = Eigen::Matrix3d::Zero();  //!< sum of seen * [midpoint]x
    double squared = 0;
    double weight = 0;
    std::size_t pairs = 0;
};

/** How far the common normal of two lines can be trusted, 0 to 1. It is off by the noise of the
 *  lines' ends over their lengths, and the more the smaller the angle between them. Without that,
 *  pairs of short lines see every direction, and best where the sensor stands still: there the
 *  rings draw nearly the same lines again. */
double trustIn(double firstLength, double secondLength, double sineOfAngle,
               const LineRegistrationOptions& options) {
    if (options.centroids) return 1;
    const double error = options.short_length * std::hypot(1 / firstLength, 1 / secondLength) /
                         std::max(sineOfAngle, 1e-6);
    return 1 / (1 + error * error * error * error);
}

Sums sumPairs(const LineCloud& from, const LineCloud& to, const Eigen::Vector3d& t,
              const std::vector<Match>& matches, const LineRegistrationOptions& options) {
    const double mean = meanDistance(matches);
    Sums sums;
    for (std::size_t i = 0; i < matches.size(); ++i) {
        if (matches[i].distance < 0 || static_cast<double>(matches[i].distance) > mean) continue;
        const auto s = static_cast<Eigen::Index>(i), f = static_cast<Eigen::Index>(matches[i].from);
        const Eigen::Vector3d us = to.directions.col(s).cast<double>();
        const Eigen::Vector3d ut = from.directions.col(f).cast<double>();
        const auto closest =
            closestPoints(to.midpoints.col(s).cast<double>() + t, us,
                          from.midpoints.col(f).cast<double>(), ut, options.min_angle_deg);
        if (closest.parallel && !options.centroids) continue;
        const Eigen::Vector3d d = closest.onTarget - closest.onSource;
        const Eigen::Vector3d normal = us.cross(ut);
        // Skew lines see the direction of their common normal: that of the surface which both lie
        // on. (Nearly) parallel ones see everything but their own direction; they are only used
        // with centroids.
        const Eigen::Matrix3d seen =
            closest.parallel ? Eigen::Matrix3d(Eigen::Matrix3d::Identity() - ut * ut.transpose())
                             : Eigen::Matrix3d(normal * normal.transpose() / normal.squaredNorm());
        const double weight = trustIn(static_cast<double>(to.lengths[s]),
                                      static_cast<double>(from.lengths[f]), normal.norm(), options);
        sums.seen += weight * seen;
        sums.lever += weight * seen * hat(to.midpoints.col(s).cast<double>());
        sums.d += weight * d;
        sums.squared += weight * d.squaredNorm();
        sums.weight += weight;
        ++sums.pairs;
    }
    return sums;
}

/** (sum seen)^-1 d without the directions that are not seen. */
Eigen::Vector3d solveSeen(const Sums& sums, double min_observability) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(sums.seen / sums.weight);
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d axis = axes.eigenvectors().col(k);
        if (axes.eigenvalues()[k] >= min_observability)
            step += axis * axis.dot(sums.d) / (axes.eigenvalues()[k] * sums.weight);
    }
    return step;
}

/** Where each direction stands: seen ones get noise over geometry, the others the prediction and
 *  the motion model's variance. */
void settle(const Sums& sums, const Eigen::Vector3d& predicted,
            const LineRegistrationOptions& options, TranslationEstimate& estimate) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(sums.seen / sums.weight);
    estimate.observability = axes.eigenvalues();
    estimate.residual_m = std::sqrt(sums.squared / sums.weight);
    const double residual = std::max(estimate.residual_m, kLeastResidual_m);
    const double noise = residual * residual / (options.independent_share * sums.weight);
    for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d axis = axes.eigenvectors().col(k);
        const bool observed = axes.eigenvalues()[k] >= options.min_observability;
        if (!observed) {
            estimate.translation -= axis * axis.dot(estimate.translation - predicted);
            estimate.unobservedAxes.conservativeResize(3, estimate.unobservedAxes.cols() + 1);
            estimate.unobservedAxes.rightCols<1>() = axis;
        }
        // A point p moves by w x p where the rotation is off by w; the translation undoes that.
        if (observed)
            estimate.lever +=
                axis * axis.transpose() * sums.lever / (axes.eigenvalues()[k] * sums.weight);
        estimate.covariance +=
            (observed ? noise / axes.eigenvalues()[k] : options.prior_sigma * options.prior_sigma) *
            axis * axis.transpose();
    }
}

double overlapOf(const std::vector<Match>& matches, double distance) {
    const auto near = std::count_if(matches.begin(), matches.end(), [&](const Match& match) {
        return match.distance >= 0 && static_cast<double>(match.distance) <= distance;
    });
    return static_cast<double>(near) / static_cast<double>(matches.size());
}

/** Mean distance between each line and the one with the nearest midpoint, metres; a line without
 *  one near it counts as `kFar`. All lines count: registration itself looks only at the better
 *  half, which wherever it ends consists of lines that fit. */
double meanLineDistance(LineMatcher& matcher, const LineCloud& to, const Eigen::Vector3d& t,
                        const LineRegistrationOptions& options) {
    constexpr double kFar = 0.3;
    const LineCloud& from = matcher.from();
    const auto matches = matcher.matches(to, t, options.max_distance);
    double sum = 0, weights = 0;
    for (std::size_t i = 0; i < matches.size(); ++i) {
        const auto s = static_cast<Eigen::Index>(i), f = static_cast<Eigen::Index>(matches[i].from);
        const double sine =
            static_cast<double>(to.directions.col(s).cross(from.directions.col(f)).norm());
        const double weight = trustIn(static_cast<double>(to.lengths[s]),
                                      static_cast<double>(from.lengths[f]), sine, options);
        const auto closest =
            closestPoints(to.midpoints.col(s).cast<double>() + t,
                          to.directions.col(s).cast<double>(), from.midpoints.col(f).cast<double>(),
                          from.directions.col(f).cast<double>(), options.min_angle_deg);
        const double distance = (closest.onTarget - closest.onSource).norm();
        sum += weight * (matches[i].distance < 0 ? kFar : std::min(distance, kFar));
        weights += weight;
    }
    return weights > 0 ? sum / weights : kFar;
}

/** The search looks at every fourth line: enough to find the basin. */
constexpr unsigned kCoarseStep = 4;

LineCloud everyNth(const LineCloud& lines, Eigen::Index n) {
    const auto columns = Eigen::seqN(0, (lines.midpoints.cols() + n - 1) / n, n);
    LineCloud some;
    some.midpoints = lines.midpoints(Eigen::all, columns);
    some.directions = lines.directions(Eigen::all, columns);
    some.lengths = lines.lengths(columns);
    return some;
}
}  // namespace

ClosestPoints closestPoints(const Eigen::Vector3d& Ps, const Eigen::Vector3d& us,
                            const Eigen::Vector3d& Pt, const Eigen::Vector3d& ut,
                            double min_angle_deg) {
    const Eigen::Vector3d w = Ps - Pt;
    const double a = us.dot(us), b = us.dot(ut), c = ut.dot(ut), d = us.dot(w), e = ut.dot(w);
    const double sine = portable::sin(min_angle_deg * M_PI / 180);
    const double denominator = a * c - b * b;  // a c sin^2 of the angle
    if (denominator <= a * c * sine * sine) return {Ps, Pt + e / c * ut, true};
    return {Ps + (b * e - c * d) / denominator * us, Pt + (a * e - b * d) / denominator * ut,
            false};
}

TranslationEstimate registerLines(const LineCloud& from, const LineCloud& to,
                                  const Eigen::Vector3d& predicted,
                                  const LineRegistrationOptions& options) {
    LineMatcher matcher(from);
    return registerLines(matcher, to, predicted, options);
}

TranslationEstimate registerLines(LineMatcher& matcher, const LineCloud& to,
                                  const Eigen::Vector3d& predicted,
                                  const LineRegistrationOptions& options) {
    TranslationEstimate estimate;
    estimate.translation = predicted;
    Sums sums;
    std::vector<Match> matches;
    while (estimate.iterations < options.max_iterations) {
        matches = matcher.matches(to, estimate.translation, options.max_distance);
        sums = sumPairs(matcher.from(), to, estimate.translation, matches, options);
        if (sums.pairs < options.min_matches) break;
        ++estimate.iterations;
        const Eigen::Vector3d step = options.centroids
                                         ? Eigen::Vector3d(sums.d / sums.weight)
                                         : solveSeen(sums, options.min_observability / kPatience);
        estimate.translation += step;
        estimate.converged = step.norm() < options.converged;
        if (estimate.converged) break;
    }
    estimate.matches = sums.pairs;
    if (sums.pairs < options.min_matches) {
        estimate.translation = predicted;
        estimate.covariance =
            options.prior_sigma * options.prior_sigma * Eigen::Matrix3d::Identity();
        estimate.unobservedAxes = Eigen::Matrix3d::Identity();
        return estimate;
    }
    estimate.valid = true;
    estimate.overlap = overlapOf(matches, options.overlap_distance);
    settle(sums, predicted, options, estimate);
    return estimate;
}

TranslationEstimate searchTranslation(const LineCloud& from, const LineCloud& to,
                                      const Eigen::Vector3d& centre, double radius,
                                      const LineRegistrationOptions& options) {
    LineMatcher matcher(from);
    return searchTranslation(matcher, to, centre, radius, options);
}

TranslationEstimate searchTranslation(LineMatcher& matcher, const LineCloud& to,
                                      const Eigen::Vector3d& centre, double radius,
                                      const LineRegistrationOptions& options) {
    const int steps = static_cast<int>(radius / options.search_step);
    if (steps == 0) return registerLines(matcher, to, centre, options);
    LineRegistrationOptions coarse = options;
    coarse.max_iterations = std::min(options.max_iterations, 10U);
    coarse.min_matches = (options.min_matches + kCoarseStep - 1) / kCoarseStep;
    const LineCloud some = everyNth(to, kCoarseStep);
    Eigen::Vector3d best = centre;
    double bestDistance = std::numeric_limits<double>::infinity();
    for (int x = -steps; x <= steps; ++x)
        for (int y = -steps; y <= steps; ++y) {
            const Eigen::Vector3d offset(x * options.search_step, y * options.search_step, 0);
            if (offset.norm() > radius) continue;
            const auto estimate = registerLines(matcher, some, centre + offset, coarse);
            if (!estimate.valid) continue;
            const double distance = meanLineDistance(matcher, some, estimate.translation, options);
            if (distance >= bestDistance) continue;
            best = estimate.translation;
            bestDistance = distance;
        }
    return registerLines(matcher, to, best, options);
}
}  // namespace delio::paper
