#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "delio/evaluation/metrics.h"
#include "generators.h"

namespace {
using namespace delio;
using namespace delio::test;
using Eigen::Isometry3d;
using Poses = std::vector<Isometry3d>;

struct Drives {
    Poses truth, estimate;
};

/** Some 60 m, and an estimate that is off by a little at each step. */
Drives drawDrives() {
    Drives drives{drawDrive(60, 1.5, 5), {Isometry3d::Identity()}};
    for (std::size_t i = 1; i < drives.truth.size(); ++i) {
        const Isometry3d step = drives.truth[i - 1].inverse() * drives.truth[i];
        drives.estimate.push_back(normalised(drives.estimate.back() * step * drawPose(0.05, 0.2)));
    }
    return drives;
}

Poses moved(const Isometry3d& world, const Poses& poses) {
    Poses result;
    for (const auto& pose : poses) result.push_back(world * pose);
    return result;
}

Poses scaled(const Poses& poses, double factor) {
    Poses result = poses;
    for (auto& pose : result) pose.translation() *= factor;
    return result;
}

/** Seen in a mirror that changes the sign of y. */
Poses mirrored(const Poses& poses) {
    const Eigen::Matrix3d M = Eigen::Vector3d(1, -1, 1).asDiagonal();
    Poses result;
    for (const auto& pose : poses)
        result.push_back(isometry(M * pose.linear() * M, M * pose.translation()));
    return result;
}

const std::vector<double> kLengths_m = {10, 20};

void expectSame(const evaluation::KittiErrors& a, const evaluation::KittiErrors& b) {
    RC_ASSERT(a.segments == b.segments);
    if (a.segments == 0) return;
    RC_ASSERT(std::abs(a.t_percent - b.t_percent) < 1e-6);
    RC_ASSERT(std::abs(a.r_deg_per_100m - b.r_deg_per_100m) < 1e-4);
}

RC_GTEST_PROP(Scores, DoNotDependOnWhereTheWorldsOriginIs, ()) {
    const Drives drives = drawDrives();
    const auto scored = evaluation::kittiErrors(drives.truth, drives.estimate, kLengths_m);
    expectSame(scored,
               evaluation::kittiErrors(moved(drawPose(100, 180), drives.truth),
                                       moved(drawPose(100, 180), drives.estimate), kLengths_m));
    const auto absolute = evaluation::absoluteError(drives.truth, drives.estimate);
    const auto elsewhere = evaluation::absoluteError(moved(drawPose(100, 180), drives.truth),
                                                     moved(drawPose(100, 180), drives.estimate));
    RC_ASSERT(std::abs(absolute.rmse_m - elsewhere.rmse_m) < 1e-6);
    RC_ASSERT(std::abs(absolute.max_m - elsewhere.max_m) < 1e-6);
}

RC_GTEST_PROP(Scores, AreTheSameInAMirror, ()) {
    const Drives drives = drawDrives();
    expectSame(
        evaluation::kittiErrors(drives.truth, drives.estimate, kLengths_m),
        evaluation::kittiErrors(mirrored(drives.truth), mirrored(drives.estimate), kLengths_m));
}

// Feet in place of metres: percents stay, distances follow.
RC_GTEST_PROP(Scores, DoNotDependOnTheUnit, ()) {
    const Drives drives = drawDrives();
    const double unit = 1.0 / 4;  // no length is rounded
    std::vector<double> lengths;
    for (const double length_m : kLengths_m) lengths.push_back(length_m * unit);
    const auto metres = evaluation::kittiErrors(drives.truth, drives.estimate, kLengths_m);
    const auto other =
        evaluation::kittiErrors(scaled(drives.truth, unit), scaled(drives.estimate, unit), lengths);
    RC_ASSERT(metres.segments == other.segments);
    if (metres.segments > 0) {
        RC_ASSERT(std::abs(metres.t_percent - other.t_percent) < 1e-6);
        RC_ASSERT(std::abs(metres.r_deg_per_100m / unit - other.r_deg_per_100m) < 1e-3);
    }
    const auto a = evaluation::absoluteError(drives.truth, drives.estimate);
    const auto b =
        evaluation::absoluteError(scaled(drives.truth, unit), scaled(drives.estimate, unit));
    RC_ASSERT(std::abs(a.rmse_m * unit - b.rmse_m) < 1e-6);
}

RC_GTEST_PROP(Scores, AreZeroForTheTruthItself, ()) {
    const Poses truth = drawDrives().truth;
    const auto scored =
        evaluation::kittiErrors(truth, moved(drawPose(100, 180), truth), kLengths_m);
    if (scored.segments > 0) RC_ASSERT(scored.t_percent < 1e-6);
    RC_ASSERT(evaluation::absoluteError(truth, moved(drawPose(100, 180), truth)).max_m < 1e-6);
}
}  // namespace
