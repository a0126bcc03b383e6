#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "delio/odometry/odometry.h"
#include "delio/slam/options.h"
#include "generators.h"
#include "poses.h"
#include "ring_scan.h"

// What must not matter to an odometry: how the sensor is turned on the vehicle, on which hand the
// world is, in which order points come, where the drive begins.
namespace {
using namespace delio;
using namespace delio::test;
using Eigen::Isometry3d;
using Eigen::Matrix3Xf;
using Poses = std::vector<Isometry3d>;
using Clouds = std::vector<Matrix3Xf>;

constexpr double kMetres = 0.02, kDegrees = 0.2;

struct Drive {
    Poses truth;  //!< from the first scan's frame
    Clouds clouds;
};

/** Four scans through the yard from somewhere in it, in some direction, up to 0.8 m a scan. */
Drive drawYardDrive() {
    Isometry3d pose = poseAtDeg(5 + drawReal(5), drawReal(2), 0, *rc::gen::inRange(-180, 181));
    const Isometry3d step =
        poseAtDeg(0.4 + drawReal(0.4), drawReal(0.1), 0, drawReal(3), drawReal(0.3), drawReal(0.3));
    Drive drive;
    Noise noise(static_cast<std::uint32_t>(*rc::gen::inRange(1, 1000)));
    Poses poses;
    for (int i = 0; i < 4; ++i, pose = pose * step) {
        poses.push_back(pose);
        drive.clouds.push_back(ringScan(yard(), pose, {28, 400, -24, 8, 0.01}, noise).points);
    }
    drive.truth = fromFirst(poses);
    return drive;
}

struct Found {
    Poses poses;
    std::vector<bool> isSure;  //!< nothing of the latest step is named as unobserved
};

Found driveOf(const Clouds& clouds) {
    const auto odometry = makeOdometry(Options::ofProfile("accurate"));
    Found found;
    for (const auto& cloud : clouds) {
        Scan scan = scanOf(cloud);
        scan.stamp_s = 0.1 * static_cast<double>(found.poses.size());
        const Step step = odometry->process(scan);
        RC_ASSERT(!step.predicted);
        found.poses.push_back(found.poses.empty() ? step.increment.pose
                                                  : found.poses.back() * step.increment.pose);
        found.isSure.push_back(step.quality.unobservedTranslation.cols() == 0);
    }
    return found;
}

/** What is off is named. (Rings lie on rings: points may say "standing still" along an axis that
 *  planes do not see.) */
void expectNear(const Found& found, const Poses& truth) {
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (!found.isSure[i]) continue;
        RC_ASSERT(metresBetween(found.poses[i], truth[i]) < kMetres);
        RC_ASSERT(degreesBetween(found.poses[i], truth[i]) < kDegrees);
    }
}

RC_GTEST_PROP(Odometry, FindsTheDriveFromAnywhere, ()) {
    const Drive drive = drawYardDrive();
    expectNear(driveOf(drive.clouds), drive.truth);
}

RC_GTEST_PROP(Odometry, DoesNotDependOnHowTheSensorIsTurned, ()) {
    const Drive drive = drawYardDrive();
    const Isometry3d S = poseAtDeg(0, 0, 0, *rc::gen::inRange(-180, 181));
    Clouds turned;
    for (const auto& cloud : drive.clouds)
        turned.push_back(S.inverse().linear().cast<float>() * cloud);
    Poses truth;
    for (const auto& pose : drive.truth) truth.push_back(S.inverse() * pose * S);
    expectNear(driveOf(turned), truth);
}

RC_GTEST_PROP(Odometry, FindsTheMirroredDriveInAMirror, ()) {
    const Drive drive = drawYardDrive();
    const Eigen::Vector3d M(1, -1, 1);
    Clouds mirrored;
    for (const auto& cloud : drive.clouds) mirrored.push_back(M.cast<float>().asDiagonal() * cloud);
    Poses truth;
    for (const auto& pose : drive.truth)
        truth.push_back(isometry(M.asDiagonal() * pose.linear() * M.asDiagonal(),
                                 M.asDiagonal() * pose.translation()));
    expectNear(driveOf(mirrored), truth);
}

RC_GTEST_PROP(Odometry, DoesNotDependOnTheOrderOfPoints, ()) {
    const Drive drive = drawYardDrive();
    Clouds shuffled = drive.clouds;
    for (auto& cloud : shuffled) {
        std::mt19937 engine(static_cast<std::uint32_t>(*rc::gen::inRange(1, 1000)));
        for (Eigen::Index i = cloud.cols() - 1; i > 0; --i)
            cloud.col(i).swap(cloud.col(engine() % static_cast<std::uint32_t>(i + 1)));
    }
    expectNear(driveOf(shuffled), drive.truth);
}

// The scans of a drive that begins later are steps of the same drive.
RC_GTEST_PROP(Odometry, DoesNotDependOnWhereTheDriveBegins, ()) {
    const Drive drive = drawYardDrive();
    const Clouds later(drive.clouds.begin() + 1, drive.clouds.end());
    expectNear(driveOf(later), fromFirst({drive.truth.begin() + 1, drive.truth.end()}));
}
}  // namespace
