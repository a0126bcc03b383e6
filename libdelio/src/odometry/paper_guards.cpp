#include "odometry/paper_guards.h"

#include <algorithm>
#include <cmath>

#include "core/voxel_grid.h"
#include "delio/core/geometry.h"
#include "delio/core/stopwatch.h"
#include "odometry/paper_odometry.h"
#include "odometry/search_points.h"
#include "paper/line_registration.h"
#include "paper/rotation_in_place.h"

namespace delio::odometry {
CheckPoints checkPointsOf(const Eigen::Matrix3Xf& points, const Eigen::Matrix3f& upright,
                          const PointCheckOptions& options, const PointMapOptions& map) {
    CheckPoints check{{}, PointMap(map), upright};
    const Eigen::Matrix3Xf fine = voxelCentroids(points, options.map_spacing);
    check.map.add(fine.cast<double>());
    check.points = firstOfVoxels(fine, options.point_spacing).cast<double>();
    return check;
}

PointEstimate checkByPoints(const CheckPoints& from, const CheckPoints& to,
                            const Eigen::Isometry3d& found, const Eigen::Isometry3d& predicted,
                            double reach, const PointCheckOptions& options,
                            const PointRegistrationOptions& registration) {
    const auto& points = to.points;
    Eigen::Isometry3d rest = predicted;  // a rotation that was found may be off by much
    rest.translation().setZero();
    const auto moved = pointsOff(from.map, points, rest, options.rest);
    const auto shareOf = [&](const Eigen::Isometry3d& pose) {
        return shareAt(from.map, moved, pose, registration.last_kernel);
    };
    PointEstimate best;
    double most = 0;
    const auto compare = [&](const PointEstimate& placed) {
        const double share = placed.valid ? shareOf(placed.pose) : 0;
        if (share <= most) return;
        most = share;
        best = placed;
    };
    const double kernel = registration.least_kernel;
    compare(registerToPoints(from.map, points, found, kernel, registration));
    if (most < options.min_share || !agree(best.pose, found, options)) {
        compare(registerToPoints(from.map, points, predicted, kernel, registration));
        compare(searchPoints(from.map, points, rest, {reach, 0}, to.upright, registration));
    }
    const auto least = options.min_moved * static_cast<double>(points.cols());
    best.valid = static_cast<double>(moved.cols()) >= least && most >= options.min_share &&
                 most > shareOf(found);
    return best;
}

bool agree(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b,
           const PointCheckOptions& options) {
    return (a.translation() - b.translation()).norm() <= options.tolerance &&
           angleOf(a.linear().transpose() * b.linear()) <= options.tolerance_deg * M_PI / 180;
}

namespace {
constexpr double kDeg = M_PI / 180;

/** Rotation and translation again, now that it is known which normals were found at one place. */
void refineInPlace(const PaperFeatures& from, const PaperFeatures& to,
                   const PaperOdometryOptions& options, PaperRegistration& found) {
    if (options.inPlace.rounds == 0) return;
    paper::LineMatcher matcher(from.lines);
    for (unsigned round = 0; round < options.inPlace.rounds; ++round) {
        if (!found.rotation.valid || !found.translation.valid) return;
        const Eigen::Vector3d t = found.translation.translation;
        found.rotation =
            paper::registerInPlace(from.pattern, to.pattern, found.rotation, t, options.inPlace);
        found.translation =
            paper::registerLines(matcher, paper::rotated(to.lines, found.rotation.rotation), t,
                                 options.lineRegistration);
    }
}

Eigen::Isometry3d poseOf(const PaperRegistration& found) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = found.rotation.rotation;
    pose.translation() = found.translation.translation;
    return pose;
}

void nameAxis(const Eigen::Vector3d& axis, double sigma, Eigen::Matrix3Xd& axes,
              Eigen::Matrix3d& covariance) {
    axes.conservativeResize(3, axes.cols() + 1);
    axes.rightCols<1>() = axis;
    covariance += sigma * sigma * axis * axis.transpose();
}

/** Where rotation or translation lead away from `placed` they do not know better: these axes stay
 *  as points have them. */
void hold(const Eigen::Isometry3d& placed, const PaperOdometryOptions& options,
          PaperRegistration& found) {
    auto& rotation = found.rotation;
    auto& translation = found.translation;
    const Eigen::Vector3d turned = rotationLog(placed.linear().transpose() * rotation.rotation);
    if (turned.norm() > options.check.tolerance_deg * kDeg) {
        rotation.rotation = placed.linear();
        nameAxis(turned.normalized(), options.pattern.prior_sigma_deg * kDeg,
                 rotation.unobservedAxes, rotation.covariance);
    }
    const Eigen::Vector3d off = translation.translation - placed.translation();
    if (off.norm() > options.check.tolerance) {
        translation.translation = placed.translation();
        nameAxis(off.normalized(), options.lineRegistration.prior_sigma, translation.unobservedAxes,
                 translation.covariance);
    }
}

void guard(const PaperFeatures& from, const PaperFeatures& to, const Eigen::Isometry3d& guess,
           const PaperOdometryOptions& options, PaperRegistration& found) {
    refineInPlace(from, to, options, found);
    if (!found.predictedReason.empty() || !from.check || !to.check) return;
    const double reach = std::max(options.check.reach, 1.5 * guess.translation().norm());
    const auto placed = checkByPoints(*from.check, *to.check, poseOf(found), guess, reach,
                                      options.check, options.points);
    if (!placed.valid || agree(placed.pose, poseOf(found), options.check)) return;
    found = registerByPatternAndLines(from, to, placed.pose, 0, options);
    refineInPlace(from, to, options, found);
    hold(placed.pose, options, found);
    found.denied = true;
}
}  // namespace

void applyGuards(const PaperFeatures& from, const PaperFeatures& to, const Eigen::Isometry3d& guess,
                 const PaperOdometryOptions& options, PaperRegistration& found) {
    if (!options.guarded()) return;
    double ms = 0;
    timed(ms, [&] { guard(from, to, guess, options, found); });
    found.guards_ms = ms;
}

bool applyGuardsToLink(const PaperFeatures& from, const PaperFeatures& to,
                       const Eigen::Isometry3d& guess, const PaperOdometryOptions& options,
                       PaperRegistration& found) {
    refineInPlace(from, to, options, found);
    if (!from.check || !to.check) return true;
    PointCheckOptions wider = options.check;  // seen from afar, surfaces differ
    wider.tolerance *= 2;
    wider.tolerance_deg *= 2;
    const auto placed =
        checkByPoints(*from.check, *to.check, poseOf(found), guess, 0, wider, options.points);
    return !placed.valid || agree(placed.pose, poseOf(found), wider);
}
}  // namespace delio::odometry
