#include "odometry/register_points.h"

#include <tbb/parallel_for.h>
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/principal_axes.h"
#include "delio/core/geometry.h"

namespace delio::odometry {
Pairing::Pairing(const PointMap& map, const Eigen::Matrix3Xd& points)
    : map_(map), points_(points), latest_(static_cast<std::size_t>(points.cols())) {}

/** Whether what was found of it holds where it is now placed, within `reach`. */
bool Pairing::isStill(const Latest& latest, const Eigen::Vector3d& placed, double reach) {
    constexpr double kRounding_m = 1e-3;  // distances are compared as floats
    const auto& [nearest, at] = latest;
    const double away = nearest.any ? std::min(reach, (nearest.point - placed).norm()) : reach;
    return away + (placed - at).norm() + kRounding_m < nearest.others_m;
}

/** Of the points from `first` on, each `every`-th one. */
void Pairing::pairBlock(const Eigen::Isometry3d& pose, double kernel, Eigen::Index first,
                        Eigen::Index every, Pair* pairs, std::size_t count) {
    constexpr double kReach = 3;  // kernel widths
    // Farther than needed now: an empty neighbourhood is then not searched again soon.
    constexpr double kFarthest = std::numeric_limits<double>::max();
    const double reach = kReach * kernel;
    std::array<Eigen::Vector3d, kBlock> placed;
    std::array<std::size_t, kBlock> moved;
    Eigen::Matrix<double, 3, kBlock> sought;
    std::size_t movedCount = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Eigen::Index point = first + static_cast<Eigen::Index>(i) * every;
        placed[i] = pose * points_.col(point);
        if (isStill(latest_[static_cast<std::size_t>(point)], placed[i], reach)) continue;
        sought.col(static_cast<Eigen::Index>(movedCount)) = placed[i];
        moved[movedCount++] = static_cast<std::size_t>(point);
    }
    const auto nearest =
        map_.nearestOf(sought.leftCols(static_cast<Eigen::Index>(movedCount)), kFarthest);
    for (std::size_t k = 0; k < movedCount; ++k)
        latest_[moved[k]] = {nearest[k], sought.col(static_cast<Eigen::Index>(k))};
    for (std::size_t i = 0; i < count; ++i) {
        const Eigen::Index point = first + static_cast<Eigen::Index>(i) * every;
        const auto& found = latest_[static_cast<std::size_t>(point)].nearest;
        const double squared = (found.point - placed[i]).squaredNorm();
        if (!found.any || squared >= reach * reach) continue;
        const double robust = 1 / (1 + squared / (kernel * kernel));
        pairs[i] = {point, found.point, squared, robust * robust};
    }
}

Pairs Pairing::at(const Eigen::Isometry3d& pose, double kernel, Eigen::Index every) {
    Pairs pairs(static_cast<std::size_t>((points_.cols() + every - 1) / every));
    tbb::parallel_for(std::size_t{0}, (pairs.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
        const std::size_t first = block * kBlock;
        pairBlock(pose, kernel, static_cast<Eigen::Index>(first) * every, every,
                  pairs.data() + first, std::min(kBlock, pairs.size() - first));
    });
    return pairs;
}

namespace {
constexpr double kTypicalRange_m = 20;
}  // namespace

Vector6 stepBetween(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    Vector6 step;
    step << b.translation() - a.translation(),
        kTypicalRange_m * rotationLog(a.linear().transpose() * b.linear());
    return step;
}

namespace {
/** Rotation about the centroids, then the translation. False with too few pairs. */
bool solve(const Eigen::Matrix3Xd& points, const Pairs& pairs, unsigned least,
           Eigen::Isometry3d& pose) {
    Eigen::Vector3d inMap = Eigen::Vector3d::Zero(), inScan = inMap;
    double weight = 0;
    unsigned count = 0;
    for (const auto& pair : pairs) {
        inMap += pair.weight * pair.inMap;
        inScan += pair.weight * points.col(pair.point);
        weight += pair.weight;
        count += pair.weight > 0;
    }
    if (count < least) return false;
    inMap /= weight;
    inScan /= weight;
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
    for (const auto& pair : pairs)
        moment +=
            pair.weight * (pair.inMap - inMap) * (points.col(pair.point) - inScan).transpose();
    pose.linear() = rotationOf(moment);
    pose.translation() = inMap - pose.linear() * inScan;
    return true;
}

/** Iterations with pairs that are anew the nearest ones creep towards where they end, each step a
 *  share of the one before: where two went one way, what is left of that row is gone at once
 *  (Aitken), but no farther than `most`, within which pairs stay much the same. False where they
 *  did not. */
bool extrapolate(const Vector6& before, const Vector6& step, double most, Eigen::Isometry3d& pose) {
    constexpr double kOneWay = 0.9, kMost = 5;
    const double along = step.dot(before);
    if (along < kOneWay * step.norm() * before.norm()) return false;
    const double ratio = along / before.squaredNorm();
    const double left =
        std::min(ratio < 1 ? std::min(ratio / (1 - ratio), kMost) : kMost, most / step.norm());
    pose.translation() += left * step.head<3>();
    pose.linear() = normalised(
        Eigen::Matrix3d(pose.linear() * rotationExp(left / kTypicalRange_m * step.tail<3>())));
    return true;
}

/** With one kernel and each `every`-th point, until steps are shorter than `enough`. False with too
 *  few pairs. */
bool iterate(Pairing& pairing, Eigen::Index every, double width, double enough,
             const PointRegistrationOptions& options, PointEstimate& estimate) {
    // Between two places that attract alike extrapolation goes back and forth: no more often.
    constexpr unsigned kExtrapolations = 8;
    unsigned extrapolated = 0;
    Vector6 latest = Vector6::Zero();
    for (unsigned i = 0; i < options.max_iterations; ++i) {
        const Eigen::Isometry3d before = estimate.pose;
        if (!solve(pairing.points(), pairing.at(before, width, every), options.min_matches,
                   estimate.pose))
            return false;
        ++estimate.iterations;
        const Vector6 step = stepBetween(before, estimate.pose);
        estimate.converged = step.head<3>().norm() + step.tail<3>().norm() < enough;
        if (estimate.converged) break;
        const bool isOn = extrapolated < kExtrapolations && !latest.isZero() &&
                          extrapolate(latest, step, width / 2, estimate.pose);
        extrapolated += isOn;
        latest = isOn ? Vector6::Zero() : step;
    }
    return true;
}

void judge(Pairing& pairing, const PointRegistrationOptions& options, PointEstimate& estimate) {
    double squares = 0;
    for (const auto& pair : pairing.at(estimate.pose, options.last_kernel)) {
        if (pair.weight == 0 || pair.squaredDistance > options.last_kernel * options.last_kernel)
            continue;
        squares += pair.squaredDistance;
        ++estimate.matches;
    }
    const auto matches = static_cast<double>(estimate.matches);
    estimate.inlierRatio =
        matches / static_cast<double>(std::max<Eigen::Index>(pairing.points().cols(), 1));
    estimate.residual_m = matches > 0 ? std::sqrt(squares / matches) : 0;
}
}  // namespace

PointEstimate registerToPoints(const PointMap& map, const Eigen::Matrix3Xd& points,
                               const Eigen::Isometry3d& predicted, double kernel,
                               const PointRegistrationOptions& options) {
    PointEstimate estimate;
    estimate.pose = predicted;
    estimate.kernel_m = std::max(kernel, options.last_kernel);
    // A part of the points leads near the last kernel as well; all of them from there. Where the
    // motion is not known it is larger. (With 2000 an OS1-64 that starts from rest on a highway is
    // off by 0.2 %, not 0.02 %.)
    constexpr Eigen::Index kEnough = 4000, kEnoughIfKnown = 1000;
    const Eigen::Index enough = kernel < options.first_kernel ? kEnoughIfKnown : kEnough,
                       stride = strideOf(points.cols(), enough);
    Pairing pairing(map, points);
    for (double width = estimate.kernel_m;; width = std::max(width / 2, options.last_kernel)) {
        // Only the last kernel has to converge; the others lead into its reach.
        constexpr double kRough = 0.02;
        const bool isLast = width <= options.last_kernel;
        if (!iterate(pairing, isLast ? 1 : stride, width,
                     isLast ? options.converged_m : kRough * width, options, estimate)) {
            estimate.pose = predicted;
            estimate.converged = false;
            return estimate;
        }
        if (isLast) break;
    }
    judge(pairing, options, estimate);
    estimate.valid = estimate.inlierRatio >= options.min_share;
    return estimate;
}

namespace {
std::vector<PointMap::Nearest> nearestAt(const PointMap& map,
                                         const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                         const Eigen::Isometry3d& pose, double distance) {
    return map.nearestOf((pose.linear() * points).colwise() + pose.translation(), distance);
}
}  // namespace

double shareAt(const PointMap& map, const Eigen::Matrix3Xd& points, const Eigen::Isometry3d& pose,
               double distance, double least) {
    constexpr Eigen::Index kTogether = 64;
    const Eigen::Index all = points.cols();
    const double needed = least * static_cast<double>(all);
    Eigen::Index near = 0;
    for (Eigen::Index i = 0; i < all; i += kTogether) {
        if (static_cast<double>(near + all - i) < needed) return 0;
        const auto part = points.middleCols(i, std::min(kTogether, all - i));
        for (const auto& nearest : nearestAt(map, part, pose, distance)) near += nearest.any;
    }
    return static_cast<double>(near) / static_cast<double>(std::max<Eigen::Index>(all, 1));
}

Eigen::Matrix3Xd pointsOff(const PointMap& map, const Eigen::Matrix3Xd& points,
                           const Eigen::Isometry3d& pose, double distance) {
    Eigen::Matrix3Xd off(3, points.cols());
    Eigen::Index count = 0, i = 0;
    for (const auto& nearest : nearestAt(map, points, pose, distance)) {
        if (!nearest.any) off.col(count++) = points.col(i);
        ++i;
    }
    off.conservativeResize(3, count);
    return off;
}
}  // namespace delio::odometry
