#include "odometry/pipeline.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "delio/slam/options.h"
#include "odometry/deskew.h"
#include "poses.h"
#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using Eigen::Isometry3d;
using test::degreesBetween;
using test::metresBetween;
using test::poseAt;

PlaneOdometryOptions accurate() { return Options::ofProfile("accurate").planes; }

Eigen::Matrix3Xf pointsSeenFrom(const test::Scene& scene, const Isometry3d& pose,
                                test::Noise& noise) {
    return ringScan(scene, pose, {48, 900, -24, 8, 0.01}, noise).points;
}

/** Scans of a drive through the yard that is moving from the first scan on. */
std::vector<Scan> driveScans(const std::vector<double>& x, test::Noise& noise) {
    std::vector<Scan> scans;
    for (std::size_t i = 0; i < x.size(); ++i) {
        scans.push_back(
            test::scanOf(pointsSeenFrom(test::yard(), poseAt(x[i], 0, 0, 0.01 * x[i]), noise)));
        scans.back().stamp_s = x[i] / 10;  // at 10 m/s
    }
    return scans;
}

// The recording pauses for a quarter of an hour, or a clock is set to its date, and the vehicle is
// where it would have been a scan later: it is found in the old map.
TEST(PlaneOdometry, IsFoundAgainAfterALongPause) {
    for (const double pause_s : {60.0, 1.3e9}) {
        test::Noise noise;
        const std::vector<double> x = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
        auto scans = driveScans(x, noise);
        for (std::size_t i = 4; i < scans.size(); ++i) scans[i].stamp_s += pause_s;
        PlaneOdometry odometry(accurate());
        for (std::size_t i = 0; i < x.size(); ++i) {
            const auto result = odometry.process(scans[i]);
            EXPECT_FALSE(result.predicted) << i << " " << result.reason;
            EXPECT_EQ(result.interrupted, i == 4) << i;
            if (i == 0) continue;
            const Isometry3d truth =
                poseAt(x[i - 1], 0, 0, 0.01 * x[i - 1]).inverse() * poseAt(x[i], 0, 0, 0.01 * x[i]);
            EXPECT_LT(metresBetween(result.increment.pose, truth), 0.03) << i;
            const Matrix6& C = result.increment.covariance;
            const double sigma = std::sqrt(C.topLeftCorner<3, 3>().trace());
            EXPECT_LT(metresBetween(result.increment.pose, truth), std::max(3 * sigma, 0.03)) << i;
        }
    }
}

// Parked meanwhile: at constant speed it would be 18 km away.
TEST(PlaneOdometry, AParkedVehicleIsWhereItWas) {
    test::Noise noise;
    auto scans = driveScans({0, 1, 2, 3, 3, 3}, noise);
    for (std::size_t i = 0; i < scans.size(); ++i)
        scans[i].stamp_s = 0.1 * static_cast<double>(i) + (i < 4 ? 0 : 1800);
    PlaneOdometry odometry(accurate());
    for (std::size_t i = 0; i < scans.size(); ++i) {
        const auto result = odometry.process(scans[i]);
        EXPECT_FALSE(result.predicted) << i << " " << result.reason;
        if (i > 3) {
            EXPECT_LT(result.increment.pose.translation().norm(), 0.03) << i;
        }
    }
}

TEST(PlaneOdometry, FollowsADriveAlsoWhereScansAreMissingOrEmpty) {
    test::Noise noise;
    const std::vector<double> x = {0, 1, 2, 3, 6, 7, 8, 9, 10};  // two are lost after 3
    auto scans = driveScans(x, noise);
    scans[6] = test::scanOf(Eigen::Matrix3Xf(3, 0));
    scans[6].stamp_s = 0.8;
    PlaneOdometry odometry(accurate());
    Isometry3d pose = Isometry3d::Identity();
    for (std::size_t i = 0; i < x.size(); ++i) {
        const auto result = odometry.process(scans[i]);
        pose = pose * result.increment.pose;
        EXPECT_EQ(result.predicted, i == 6) << i;
        EXPECT_EQ(result.reason.empty(), i != 6);
        const Isometry3d truth = poseAt(x[i], 0, 0, 0.01 * x[i]);
        EXPECT_LT(metresBetween(pose, truth), i == 6 ? 0.1 : 0.02) << i;
        EXPECT_LT(degreesBetween(pose, truth), 0.1) << i;
        const Matrix6& C = result.increment.covariance;
        if (i == 0) continue;
        EXPECT_EQ(C.llt().info(), Eigen::Success) << C;
    }
}

// The motion is not known yet: what was driven meanwhile was driven in two intervals.
TEST(PlaneOdometry, ASecondScanWithoutPointsDoesNotDoubleTheSpeed) {
    test::Noise noise;
    const std::vector<double> x = {0, 1.2, 2.4, 3.6, 4.8};
    for (const bool stampsRise : {true, false}) {
        auto scans = driveScans(x, noise);
        scans[1].points = test::scanOf(Eigen::Matrix3Xf(3, 0)).points;
        PlaneOdometry odometry(accurate());
        for (std::size_t i = 0; i < x.size(); ++i) {
            scans[i].stamp_s = stampsRise ? 0.1 * static_cast<double>(i) : 7;
            const auto result = odometry.process(scans[i]);
            EXPECT_EQ(result.predicted, i == 1);
            const double driven_m = i < 2 ? 0 : i == 2 ? 2.4 : 1.2;
            EXPECT_NEAR(result.increment.pose.translation().norm(), driven_m, 0.03) << i;
        }
    }
}

/** As a sensor sees it that turns once in 0.1 s while it moves on by `step`: each point in the
 *  sensor's frame at the time of its azimuth. */
void skew(Scan& scan, const Isometry3d& step) {
    const auto& x = scan.points->getPointsBufferRef_x();
    Eigen::Matrix3Xf points(3, static_cast<Eigen::Index>(x.size()));
    for (std::size_t i = 0; i < x.size(); ++i)
        scan.points->getPointFast(i, points(0, static_cast<Eigen::Index>(i)),
                                  points(1, static_cast<Eigen::Index>(i)),
                                  points(2, static_cast<Eigen::Index>(i)));
    auto times_s = odometry::azimuthTimes(points, 0.1);
    for (auto& time_s : times_s) time_s = -time_s;  // deskew() undoes the motion
    const Scan skewed = test::scanOf(odometry::deskew(points, times_s, Twist::of(step, 0.1)));
    scan.points = skewed.points;
    for (const float time_s : times_s) scan.times_s.push_back(-time_s);
}

/** Turns between the scans of a drive through a bend that begins and ends, at 10 m/s. */
const std::vector<double> kBend_rad = {0, 0, 0.01, 0.02, 0.03, 0.04, 0.05, 0.05, 0.04, 0.03, 0.02};

double medianError_m(const std::vector<Scan>& scans, const PlaneOdometryOptions& options) {
    PlaneOdometry odometry(options);
    odometry.process(scans[0]);
    std::vector<double> errors_m;
    for (std::size_t i = 1; i < scans.size(); ++i) {
        const Isometry3d step = odometry.process(scans[i]).increment.pose;
        errors_m.push_back(metresBetween(step, poseAt(1, 0, 0, kBend_rad[i - 1])));
    }
    std::sort(errors_m.begin(), errors_m.end());
    return errors_m[errors_m.size() / 2];
}

TEST(PlaneOdometry, ScansWhosePointsHaveTimesAreDeskewedFromTheFirstOn) {
    test::Noise noise;
    std::vector<Scan> scans;
    Isometry3d pose = Isometry3d::Identity();
    for (std::size_t i = 0; i < kBend_rad.size(); ++i) {
        scans.push_back(test::scanOf(pointsSeenFrom(test::yard(), pose, noise)));
        scans.back().stamp_s = 0.1 * static_cast<double>(i);
        // The sweep lies halfway in the step before and halfway in the one after.
        const double before = kBend_rad[i == 0 ? 0 : i - 1], after = kBend_rad[i];
        skew(scans.back(), poseAt(1, 0, 0, (before + after) / 2));
        pose = pose * poseAt(1, 0, 0, after);
    }
    auto options = accurate();
    const double deskewed_m = medianError_m(scans, options);
    EXPECT_LT(deskewed_m, 0.0042);
    options.scan.deskew = false;
    EXPECT_GT(medianError_m(scans, options), 3 * deskewed_m);
    // Without times, from the azimuth.
    for (auto& scan : scans) scan.times_s.clear();
    options.scan.deskew = true;
    options.scan.sweep_s = 0.1;
    EXPECT_LT(medianError_m(scans, options), 0.004);
}

// 35 m/s, of which every second scan is given: rings and rails look the same at rest.
TEST(PlaneOdometry, TheFirstMotionIsLookedForAsFarAsItsTimeAllows) {
    constexpr double kDriven_m = 7, kBetween_s = 0.2;
    test::Noise noise;
    PlaneOdometry odometry(accurate());
    for (int i = 0; i < 3; ++i) {
        Scan scan =
            test::scanOf(pointsSeenFrom(test::highway(true), poseAt(kDriven_m * i, 0, 0), noise));
        scan.stamp_s = kBetween_s * i;
        const auto result = odometry.process(scan);
        if (i == 0) continue;
        EXPECT_FALSE(result.predicted);
        EXPECT_LT(metresBetween(result.increment.pose, poseAt(kDriven_m, 0, 0)), 0.05) << i;
    }
}

// As a hand swings it: each turn is a quarter of the way to the other side, and none is foreseen.
TEST(PlaneOdometry, ASensorThatSwingsInTheHandIsRegistered) {
    constexpr double kSwing = 0.26, kPerScan = 2 * M_PI * 0.15;
    test::Noise noise;
    PlaneOdometry odometry(accurate());
    Isometry3d first = Isometry3d::Identity(), found = first;
    for (int i = 0; i < 20; ++i) {
        Isometry3d pose = poseAt(0.1 * i, 0, 0);
        pose.linear() = rotationExp(kSwing * Eigen::Vector3d(std::sin(kPerScan * i),
                                                             std::sin(1.1 * kPerScan * i + 1),
                                                             std::sin(0.9 * kPerScan * i + 2)));
        Scan scan = test::scanOf(pointsSeenFrom(test::yard(), pose, noise));
        scan.stamp_s = 0.1 * i;
        const auto result = odometry.process(scan);
        EXPECT_FALSE(result.predicted);
        if (i == 0) first = pose;
        found = found * result.increment.pose;
        const Isometry3d truth = first.inverse() * pose;
        EXPECT_LT(metresBetween(found, truth), 0.05) << i;
        EXPECT_LT(degreesBetween(found, truth), 0.3) << i;
    }
}

/** A sweep of 0.1 s about the stamp, of a sensor that `poseAt_s` says the pose of at any time. */
template <class PoseAt>
Scan sweptScan(double stamp_s, const PoseAt& poseAt_s, test::Noise& noise) {
    constexpr int kColumns = 360;
    Eigen::Matrix3Xf all(3, 0);
    std::vector<float> times_s;
    for (int c = 0; c < kColumns; ++c) {
        const double time_s = 0.1 * c / kColumns - 0.05;
        const Isometry3d head(Eigen::AngleAxisd(2 * M_PI * c / kColumns, Eigen::Vector3d::UnitZ()));
        const auto points = test::ringScan(test::yard(), poseAt_s(stamp_s + time_s) * head,
                                           {32, 1, -24, 8, 0.01}, noise)
                                .points;
        all.conservativeResize(3, all.cols() + points.cols());
        all.rightCols(points.cols()) = head.linear().cast<float>() * points;
        times_s.insert(times_s.end(), static_cast<std::size_t>(points.cols()),
                       static_cast<float>(time_s));
    }
    Scan scan = test::scanOf(all);
    scan.times_s.assign(times_s.begin(), times_s.end());
    scan.stamp_s = stamp_s;
    return scan;
}

// It turns by up to 7 deg during a scan, and not evenly.
TEST(PlaneOdometry, WhatSwingsWhileItSpinsIsUndistortedAsItSwings) {
    const auto swung = [](double time_s) {
        const double phase = 2 * M_PI * 1.5 * time_s;
        Isometry3d pose = poseAt(1.0 * time_s, 0.03 * std::sin(phase), 0);
        pose.linear() = rotationExp(
            5 * M_PI / 180 *
            Eigen::Vector3d(std::sin(phase), std::sin(1.1 * phase + 1), std::sin(0.9 * phase + 2)));
        return pose;
    };
    test::Noise noise;
    PlaneOdometry odometry(accurate());
    std::vector<double> metres, degrees;
    for (int i = 0; i < 25; ++i) {
        const double stamp_s = 0.1 * i;
        const auto result = odometry.process(sweptScan(stamp_s, swung, noise));
        EXPECT_FALSE(result.predicted) << i;
        if (i == 0) continue;
        const Isometry3d truth = swung(stamp_s - 0.1).inverse() * swung(stamp_s);
        metres.push_back(metresBetween(result.increment.pose, truth));
        degrees.push_back(degreesBetween(result.increment.pose, truth));
    }
    std::sort(metres.begin(), metres.end());
    std::sort(degrees.begin(), degrees.end());
    EXPECT_LT(metres[metres.size() / 2], 0.01);
    EXPECT_LT(degrees[degrees.size() / 2], 0.1);
}

/** The scan with a stamp that is `late_s` later. */
Scan stamped(Scan scan, double late_s) {
    scan.stamp_s += late_s;
    for (float& time_s : scan.times_s) time_s -= static_cast<float>(late_s);
    return scan;
}

/** Of `poses` the last one is that of the step's scan. */
void correct(std::vector<Isometry3d>& poses, const Step& step) {
    for (const CorrectedPose& corrected : step.corrected)
        poses[poses.size() - 1 - corrected.scansAgo] = poses.back() * corrected.pose;
}

/** Errors of the steps between scans of a turning drive whose stamps are `late_s` later than the
 *  middle of the turn: metres and degrees. */
std::vector<std::pair<double, double>> errorsOfSteps(double late_s, std::uint32_t seed) {
    const auto driven = [](double time_s) { return poseAt(8 * time_s, 0, 0, 0.5 * time_s); };
    test::Noise noise(seed);
    PlaneOdometry odometry(accurate());
    std::vector<Isometry3d> poses{Isometry3d::Identity()};
    for (std::size_t i = 0; i < 10; ++i) {
        const auto result = odometry.process(
            stamped(sweptScan(0.1 * static_cast<double>(i), driven, noise), late_s));
        EXPECT_FALSE(result.predicted) << i;
        if (i > 0) poses.push_back(poses.back() * result.increment.pose);
        correct(poses, result);
    }
    std::vector<std::pair<double, double>> errors;
    for (std::size_t i = 1; i < poses.size(); ++i) {
        const double stamp_s = 0.1 * static_cast<double>(i) + late_s;
        const Isometry3d found = poses[i - 1].inverse() * poses[i],
                         truth = driven(stamp_s - 0.1).inverse() * driven(stamp_s);
        errors.emplace_back(metresBetween(found, truth), degreesBetween(found, truth));
    }
    return errors;
}

// Drivers stamp the begin of a turn, its end, or the arrival of the message. The first scans are
// corrected by the later ones, which were registered to them: the step from the ones to the others
// is worse than the rest.
TEST(PlaneOdometry, TheStampMayLieOutsideTheScan) {
    std::vector<double> metres, degrees;
    for (const double late_s : {-0.1, -0.05, 0.05, 0.11})
        for (const std::uint32_t seed : {1, 2, 3, 4})
            for (const auto& [m, deg] : errorsOfSteps(late_s, seed)) {
                metres.push_back(m);
                degrees.push_back(deg);
            }
    std::sort(metres.begin(), metres.end());
    std::sort(degrees.begin(), degrees.end());
    ASSERT_EQ(metres.size(), 144U);
    EXPECT_LT(metres[metres.size() / 2], 0.005);
    EXPECT_LT(degrees[degrees.size() / 2], 0.01);
    EXPECT_LT(metres[metres.size() * 9 / 10], 0.02);
    EXPECT_LT(degrees[degrees.size() * 9 / 10], 0.05);
}

// The next scan passes the stamp, and shows the motion there better than the end of the turn does.
TEST(PlaneOdometry, AStampAtTheEndOfTheTurnIsCorrectedByTheNextScan) {
    constexpr double kLate_s = 0.05;
    const auto driven = [](double time_s) {
        return poseAt(8 * time_s + 0.1 * std::sin(5 * time_s), 0, 0, 0.2 * std::sin(4 * time_s));
    };
    std::vector<double> reported, corrected;
    for (const std::uint32_t seed : {1, 2}) {
        test::Noise noise(seed);
        PlaneOdometry odometry(accurate());
        std::vector<Isometry3d> poses{Isometry3d::Identity()};
        for (std::size_t i = 0; i < 24; ++i) {
            const double stamp_s = 0.1 * static_cast<double>(i) + kLate_s;
            const Step step =
                odometry.process(stamped(sweptScan(stamp_s - kLate_s, driven, noise), kLate_s));
            if (i > 0) poses.push_back(poses.back() * step.increment.pose);
            correct(poses, step);
            if (i < 12) continue;
            ASSERT_EQ(step.corrected.size(), 1U) << i;
            EXPECT_TRUE(step.corrected[0].staysInPlace);
            const Isometry3d now = driven(stamp_s - 0.1).inverse() * driven(stamp_s),
                             before = driven(stamp_s - 0.2).inverse() * driven(stamp_s - 0.1);
            reported.push_back(degreesBetween(step.increment.pose, now));
            corrected.push_back(degreesBetween(poses[i - 2].inverse() * poses[i - 1], before));
        }
    }
    std::sort(reported.begin(), reported.end());
    std::sort(corrected.begin(), corrected.end());
    EXPECT_LT(corrected[corrected.size() / 2], 0.6 * reported[reported.size() / 2]);
}

/** Rails, and bushes of which every other one comes again after 60 m. */
test::Scene repeatingHighway() {
    constexpr int kBushes = 80, kPeriods = 6;
    constexpr double kPeriod_m = 60;
    test::Scene scene = test::highway(false);
    test::Noise noise(5);
    const auto addBush = [&](double x, double y, double height) {
        scene.push_back({{x, y - 0.4, -1.8}, {x + 0.8, y + 0.4, height}});
    };
    for (int i = 0; i < kBushes; ++i) {
        const double y = (i % 2 ? 1 : -1) * (16 + 6 * noise.uniform());
        const double height = 0.5 + 1.5 * noise.uniform();
        const double x = kPeriod_m * (noise.uniform() + 1) / 2;
        for (int period = -3; period < kPeriods - 3; ++period)
            addBush(kPeriod_m * (period + (i % 2 ? 0 : noise.uniform() / 2)) + x, y, height);
    }
    return scene;
}

// The place 60 m ahead looks much like the one before the pause.
TEST(PlaneOdometry, APauseOnAHighwayIsNoStandstill) {
    constexpr double kSpeed_mps = 30, kPause_s = 2;
    constexpr int kBefore = 15, kAfter = 5;
    test::Noise noise;
    PlaneOdometry odometry(accurate());
    Isometry3d pose = Isometry3d::Identity();
    double time_s = 0;
    for (int i = 0; i < kBefore + kAfter; ++i) {
        if (i > 0) time_s += i == kBefore ? kPause_s + 0.1 : 0.1;
        const auto truth = poseAt(kSpeed_mps * time_s - 60, 0, 0);
        Scan scan = test::scanOf(
            ringScan(repeatingHighway(), truth, {32, 720, -24, 8, 0.01}, noise).points);
        scan.stamp_s = time_s;
        pose = pose * odometry.process(scan).increment.pose;
    }
    EXPECT_NEAR(pose.translation().x(), kSpeed_mps * time_s, 1);
}

// The first scan after a pause shows nothing. What the sensor moved until it is found again took
// longer than the scans since: it says nothing about the speed.
TEST(PlaneOdometry, WhatItMovedInAPauseIsNoSpeed) {
    constexpr double kStep_m = 1, kPause_m = 12;
    const auto isCovered = [](std::size_t i) { return i == 6 || i == 8; };
    test::Noise noise;
    PlaneOdometry odometry(accurate());
    double moved_m = 0;
    for (std::size_t i = 0; i < 9; ++i) {
        const double x = kStep_m * static_cast<double>(i) + (i < 6 ? 0 : kPause_m);
        Eigen::Matrix3Xf points = pointsSeenFrom(test::yard(), poseAt(x - 3, 0, 0), noise);
        if (isCovered(i))
            for (Eigen::Index k = 0; k < points.cols(); ++k)
                points.col(k) = 8 * noise.direction().cast<float>() + Eigen::Vector3f(0, 0, 20);
        Scan scan = test::scanOf(points);
        scan.stamp_s = x / 10;
        const Step step = odometry.process(scan);
        EXPECT_EQ(step.predicted, isCovered(i)) << i << " " << step.reason;
        moved_m = step.increment.pose.translation().x();
    }
    EXPECT_NEAR(moved_m, kStep_m, 0.2);  // the last one is predicted
}

// In a smooth corridor nothing shows how fast it drives.
TEST(PlaneOdometry, AStartInWhichAnAxisStaysUnobservedIsLost) {
    test::Noise noise;
    PlaneOdometry odometry(accurate());
    for (int i = 0; i < 6; ++i) {
        Scan scan = test::scanOf(pointsSeenFrom(test::corridor(), poseAt(i, 0, 0), noise));
        scan.stamp_s = 0.1 * i;
        EXPECT_EQ(odometry.process(scan).lost, i >= 3) << i;
    }
}

TEST(PlaneOdometry, AHundredScansOfStandstill) {
    test::Noise noise;
    PlaneOdometry odometry(accurate());
    Isometry3d pose = Isometry3d::Identity();
    for (int i = 0; i < 100; ++i) {
        Scan scan = test::scanOf(
            ringScan(test::yard(), Isometry3d::Identity(), {32, 360, -24, 8, 0.02}, noise).points);
        scan.stamp_s = 0.1 * i;
        const auto result = odometry.process(scan);
        EXPECT_FALSE(result.predicted);
        pose = pose * result.increment.pose;
        EXPECT_LT(pose.translation().norm(), 0.01) << i;
        EXPECT_LT(degreesBetween(pose, Isometry3d::Identity()), 0.02) << i;
    }
}

double detailOf(const Step& step, const std::string& name) {
    for (const auto& [known, value] : step.details)
        if (name == known) return value;
    return std::nan("");
}

/** How the sensor is mounted: as it is, in axes that are turned, and leaning (its rays, too), which
 *  the rawlog knows. */
struct Mount {
    const char* name;
    Isometry3d toVehicle;
    bool leaning;
};
class WithMount : public testing::TestWithParam<Mount> {};
INSTANTIATE_TEST_SUITE_P(PlaneOdometry, WithMount,
                         testing::Values(Mount{"Upright", poseAt(0, 0, 0), false},
                                         Mount{"TurnedAxes", poseAt(0, 0, 0, 0, 0.44), false},
                                         Mount{"OnItsSide", poseAt(0, 0, 0, 0, 0, M_PI / 2), false},
                                         Mount{"Leaning", poseAt(0, 0, 0, 0, 0, 0.35), true}),
                         [](const auto& mount) { return mount.param.name; });

Scan scanFrom(const test::Scene& scene, const Isometry3d& vehicle, const Mount& mount,
              test::Noise& noise) {
    if (!mount.leaning)
        return test::scanOf(mount.toVehicle.inverse().linear().cast<float>() *
                            pointsSeenFrom(scene, vehicle, noise));
    Scan scan = test::scanOf(pointsSeenFrom(scene, vehicle * mount.toVehicle, noise));
    scan.sensorPose = mount.toVehicle;
    return scan;
}

/** A van that keeps 5 m ahead all the way. */
TEST_P(WithMount, WhatDrivesAheadIsToldAndKeptOut) {
    const Isometry3d toVehicle = GetParam().toVehicle;
    test::Noise noise;
    PlaneOdometry odometry(accurate());
    for (int i = 0; i < 15; ++i) {
        const double x = 0.8 * i;
        test::Scene scene = test::yard();
        scene.push_back({{x + 5, -1, -1.6}, {x + 10, 1, 0.2}});
        Scan scan = scanFrom(scene, poseAt(x, 0, 0), GetParam(), noise);
        scan.stamp_s = 0.1 * i;
        const auto result = odometry.process(scan);
        ASSERT_EQ(result.used.dynamic.size(), result.used.indices.size());
        ASSERT_EQ(static_cast<std::size_t>(result.used.points.cols()), result.used.indices.size());
        const Isometry3d truth = poseAt(i == 0 ? 0 : 0.8, 0, 0),
                         found = toVehicle * result.increment.pose * toVehicle.inverse();
        EXPECT_LT(metresBetween(found, truth), 0.02) << i;
        const double dynamic = detailOf(result, "dynamic");
        EXPECT_EQ(dynamic, std::count(result.used.dynamic.begin(), result.used.dynamic.end(), 1));
        if (i < 6) continue;
        std::size_t told = 0, onVan = 0;
        for (std::size_t k = 0; k < result.used.dynamic.size(); ++k) {
            const Eigen::Vector3d p =
                toVehicle * result.used.points.col(static_cast<Eigen::Index>(k)).cast<double>();
            const bool isVan =
                p.x() > 4.9 && p.x() < 10.1 && std::abs(p.y()) < 1.1 && p.z() > -1.5 && p.z() < 0.3;
            onVan += isVan;
            told += isVan && result.used.dynamic[k];
        }
        EXPECT_GT(onVan, 1000U);
        EXPECT_GT(static_cast<double>(told), 0.9 * static_cast<double>(onVan)) << i;
        EXPECT_LT(dynamic, 1.1 * static_cast<double>(onVan)) << i;
    }
}
}  // namespace
