#include "delio/evaluation/comparison.h"

#include <gtest/gtest.h>
#include <mrpt/random/RandomGenerators.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/formats/trajectory.h"
#include "poses.h"

namespace {
using namespace delio;
using namespace delio::evaluation;
using test::poseAt;
using Poses = std::vector<Eigen::Isometry3d>;

/** A LiDAR's drive along x, without stamps. */
io::Trajectory straight(double step_m, std::size_t count) {
    io::Trajectory drive;
    for (std::size_t i = 0; i < count; ++i)
        drive.poses.push_back(test::poseAt(step_m * static_cast<double>(i), 0, 0));
    return drive;
}

/** A table of every `every`-th scan, the second of which was predicted. */
io::ScanTable every(std::size_t every, std::size_t count) {
    io::ScanTable table;
    for (std::size_t i = 0; i < count; ++i) {
        table.scans.push_back(every * i);
        table.stamps_s.push_back(7 + 0.5 * static_cast<double>(i));
        table.predicted.push_back(i == 1);
    }
    return table;
}

std::string messageOf(const io::Trajectory& reference, const io::Trajectory& estimate,
                      const io::ScanTable* scans = nullptr) {
    try {
        compare(reference, estimate, {}, scans);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

TEST(Comparison, HoldsTheScoresOfTheRowAndOfEachScan) {
    const auto compared = compare(straight(1, 301), straight(1.01, 301), {{100}, 10});
    EXPECT_EQ(compared.row.kitti.perLength.size(), 1U);
    EXPECT_NEAR(compared.row.kitti.t_percent, 1.01, 1e-9);
    EXPECT_NEAR(compared.row.rpe_m, 0.1, 1e-9);
    EXPECT_EQ(compared.perScan.translations_m.size(), 300U);
    EXPECT_NEAR(compared.perScan.translation_m.max, 0.01, 1e-9);
    EXPECT_NEAR(compared.end_error_m, 3, 1e-9);
    EXPECT_TRUE(compared.timesAreAssumed);
    EXPECT_NEAR(compared.times_s[300], 30, 1e-9);
    EXPECT_TRUE(compared.predicted.empty());
}

TEST(Comparison, TheEndErrorIsSeenFromTheFirstPoses) {
    auto moved = straight(1, 30);
    for (auto& pose : moved.poses) pose = test::poseAtDeg(40, -3, 2, 70, 5, -4) * pose;
    moved.poses.back() = moved.poses.back() * test::poseAt(0, 0.3, 0.4);
    EXPECT_NEAR(compare(straight(1, 30), moved, {}).end_error_m, 0.5, 1e-9);
}

TEST(Comparison, OfAStandstillThereIsNoPercentage) {
    EXPECT_NEAR(compare(straight(1, 31), straight(1.01, 31), {}).endError_percent(), 1, 1e-9);
    for (const double step_m : {0.0, 1e-15, 1e-4}) {
        const auto compared = compare(straight(step_m, 30), straight(0.01, 30), {});
        EXPECT_NEAR(compared.end_error_m, 0.29, 0.01);
        EXPECT_TRUE(std::isnan(compared.endError_percent())) << step_m;
    }
}

TEST(Comparison, ChoosesLengthsThatTheDriveHas) {
    const auto lengthsOf = [](const io::Trajectory& drive) {
        std::vector<double> lengths;
        for (const auto& errors : compare(drive, drive, {}).row.kitti.perLength)
            lengths.push_back(errors.length_m);
        return lengths;
    };
    EXPECT_EQ(lengthsOf(straight(1, 201)), evaluation::kittiLengths_m());
    EXPECT_EQ(lengthsOf(straight(1, 200)), evaluation::suggestedLengths_m(199));
    EXPECT_TRUE(lengthsOf(straight(0, 20)).empty());
}

TEST(Comparison, KeepsTheRowsOfTheScansThatWereUsed) {
    const auto table = every(3, 10);
    const auto compared = compare(straight(1, 30), straight(3, 10), {}, &table);
    EXPECT_EQ(compared.reference.size(), 10U);
    EXPECT_EQ(compared.unusedReference, 20U);
    EXPECT_NEAR(compared.end_error_m, 0, 1e-9);
    EXPECT_FALSE(compared.timesAreAssumed);
    EXPECT_DOUBLE_EQ(compared.times_s[9], 4.5);
    EXPECT_EQ(std::count(compared.predicted.begin(), compared.predicted.end(), true), 1);
    EXPECT_TRUE(compared.predicted[1]);

    auto stamped = straight(3, 10);  // whose stamps a reference without any cannot match
    stamped.stamps_s = table.stamps_s;
    EXPECT_NEAR(compare(straight(1, 30), stamped, {}, &table).end_error_m, 0, 1e-9);
    EXPECT_EQ(compare(straight(3, 10), straight(3, 10), {}, &table).unusedReference, 0U);
    EXPECT_EQ(messageOf(straight(1, 27), straight(3, 10), &table),
              "the ground truth has 27 rows but scan 27 was used");
    EXPECT_NE(messageOf(straight(1, 30), straight(3, 9), &table)
                  .find("9 poses but its scan table has 10"),
              std::string::npos);
}

TEST(Comparison, CountsWhatHasNoPartnerInTime) {
    auto reference = straight(1, 30), estimate = straight(1, 31);
    for (int i = 0; i < 30; ++i) reference.stamps_s.push_back(i);
    for (int i = 0; i < 31; ++i) estimate.stamps_s.push_back(i + 2);
    const auto compared = compare(reference, estimate, {});
    EXPECT_EQ(compared.reference.size(), 28U);
    EXPECT_EQ(compared.unmatchedReference, 2U);
    EXPECT_EQ(compared.unmatchedEstimate, 3U);
    EXPECT_EQ(compared.times_s.front(), 0);
    EXPECT_EQ(compared.times_s.back(), 27);
}

TEST(Comparison, ASinglePairIsNoTrap) {
    const auto compared = compare(straight(1, 1), straight(1, 1), {});
    EXPECT_EQ(compared.row.kitti.segments, 0U);
    EXPECT_TRUE(compared.perScan.translations_m.empty());
    EXPECT_EQ(compared.end_error_m, 0);
    EXPECT_TRUE(compare({}, {}, {}).times_s.empty());
}

TEST(Comparison, TheWrongFrameIsAnErrorOfItsOwn) {
    io::Trajectory camera;
    for (int i = 0; i < 30; ++i) camera.poses.push_back(test::poseAt(0, 0, i));
    try {
        compare(camera, straight(1, 30), {});
        FAIL() << "compared all the same";
    } catch (const evaluation::WrongFrames& e) {
        EXPECT_EQ(e.mismatch(), FrameMismatch::lidarAgainstCamera);
    }
    EXPECT_NE(messageOf(straight(1, 30), camera).find("estimate seems to be in the camera"),
              std::string::npos);
}

/** Poses whose x is their stamp. */
io::Trajectory stamped(const std::vector<double>& stamps_s) {
    io::Trajectory trajectory;
    trajectory.stamps_s = stamps_s;
    for (const double t : stamps_s) trajectory.poses.push_back(test::poseAt(t, 0, 0));
    return trajectory;
}

io::Trajectory unstamped(std::size_t count) {
    io::Trajectory trajectory;
    trajectory.poses.assign(count, Eigen::Isometry3d::Identity());
    return trajectory;
}

std::vector<double> xOf(const std::vector<Eigen::Isometry3d>& poses) {
    std::vector<double> xs;
    for (const auto& pose : poses) xs.push_back(pose.translation().x());
    return xs;
}

std::string associationError(const io::Trajectory& reference, const io::Trajectory& estimate) {
    try {
        associate(reference, estimate);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

TEST(Association, SaysWhichRowsBelongTogetherAndWhen) {
    const auto byRow = associate(stamped({5, 6, 7}), unstamped(3));
    EXPECT_EQ(byRow.estimateRows, (std::vector<std::size_t>{0, 1, 2}));
    EXPECT_EQ(byRow.stamps_s, (std::vector<double>{5, 6, 7}));
    EXPECT_TRUE(associate(unstamped(3), unstamped(3)).stamps_s.empty());
    const auto byStamp = associate(stamped({5, 6, 7}), stamped({4, 5.01, 7.01}));
    EXPECT_EQ(byStamp.estimateRows, (std::vector<std::size_t>{1, 2}));
    EXPECT_EQ(byStamp.stamps_s, (std::vector<double>{5, 7}));
}

TEST(Association, RowsMatchWhereEitherSideHasNoStamps) {
    EXPECT_EQ(associate(unstamped(3), unstamped(3)).estimate.size(), 3U);
    EXPECT_EQ(associate(stamped({5, 6, 7}), unstamped(3)).estimate.size(), 3U);
    EXPECT_EQ(associate(unstamped(3), stamped({5, 6, 7})).reference.size(), 3U);
}

TEST(Association, DifferentCountsOfRowsAreNamed) {
    const std::string message = associationError(unstamped(61), unstamped(60));
    EXPECT_NE(message.find("61"), std::string::npos);
    EXPECT_NE(message.find("60"), std::string::npos);
}

TEST(Association, StampsMatchTheNearestWithinTheTolerance) {
    const auto matched =
        associate(stamped({0, 0.1, 0.2, 0.3, 0.4}), stamped({0.101, 0.195, 0.25, 0.419, 0.9}));
    EXPECT_EQ(xOf(matched.reference), (std::vector<double>{0.1, 0.2, 0.4}));
    EXPECT_EQ(xOf(matched.estimate), (std::vector<double>{0.101, 0.195, 0.419}));
    EXPECT_EQ(matched.unmatchedReference, 2U);
    EXPECT_EQ(matched.unmatchedEstimate, 2U);
}

TEST(Association, NoPoseIsUsedTwice) {
    // Three estimates near one pose of the reference, and the other way round.
    const auto dense = associate(stamped({1, 2}), stamped({0.99, 1.001, 1.01}));
    EXPECT_EQ(xOf(dense.estimate), (std::vector<double>{1.001}));
    const auto sparse = associate(stamped({0.99, 1.001, 1.01}), stamped({1, 2}));
    EXPECT_EQ(xOf(sparse.reference), (std::vector<double>{1.001}));
}

TEST(Association, EveryThirdPoseOfTheReferenceIsFound) {
    std::vector<double> all, third;
    for (int i = 0; i < 300; ++i) {
        all.push_back(1.3e9 + 0.1 * i);
        if (i % 3 == 0) third.push_back(all.back());
    }
    const auto matched = associate(stamped(all), stamped(third));
    EXPECT_EQ(xOf(matched.reference), third);
    EXPECT_EQ(matched.unmatchedReference, 200U);
    EXPECT_EQ(matched.unmatchedEstimate, 0U);
}

TEST(Association, NoMatchAtAllIsAnError) {
    EXPECT_NE(associationError(stamped({0, 1, 2}), stamped({1000, 1001, 1002})).find("clock"),
              std::string::npos);
}

/** A LiDAR's winding drive, x forward. */
Poses lidarDrive(std::size_t count = 120, double step_m = 0.8) {
    Poses poses = {Eigen::Isometry3d::Identity()};
    for (std::size_t i = 1; i < count; ++i) {
        const double yaw = 0.05 * std::sin(0.1 * static_cast<double>(i));
        poses.push_back(poses.back() * poseAt(step_m, 0.01, -0.005, yaw, 0.002, 0));
    }
    return poses;
}

/** A LiDAR's pose in cam0 close to KITTI's, a degree or two off the nominal axes. */
Eigen::Isometry3d lidarToCamera() {
    Eigen::Matrix3d nominal;
    nominal << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    const Eigen::Matrix3d R =
        nominal * Eigen::AngleAxisd(0.03, Eigen::Vector3d(1, 1, -1).normalized());
    return delio::isometry(R, {-0.004, -0.076, -0.27});
}

Poses asCamera(const Poses& lidar) {
    return delio::io::lidarToCam0({lidar, {}}, lidarToCamera()).poses;
}

TEST(FrameCheck, NamesTheFrameThatIsWrong) {
    const auto lidar = lidarDrive(), camera = asCamera(lidar);
    EXPECT_EQ(findFrameMismatch(lidar, lidar), FrameMismatch::none);
    EXPECT_EQ(findFrameMismatch(camera, camera), FrameMismatch::none);
    EXPECT_EQ(findFrameMismatch(camera, lidar), FrameMismatch::lidarAgainstCamera);
    EXPECT_EQ(findFrameMismatch(lidar, camera), FrameMismatch::cameraAgainstLidar);
    EXPECT_EQ(findFrameMismatch(camera, asCamera(camera)), FrameMismatch::cameraAgainstLidar);
}

TEST(FrameCheck, DrivesInReverseAreSeenToo) {
    const auto lidar = lidarDrive(120, -0.8);
    EXPECT_EQ(findFrameMismatch(asCamera(lidar), lidar), FrameMismatch::lidarAgainstCamera);
    EXPECT_EQ(findFrameMismatch(lidar, lidar), FrameMismatch::none);
}

TEST(FrameCheck, TheFixedFrameDoesNotMatter) {
    const auto lidar = lidarDrive();
    auto moved = lidar;
    const auto world = poseAt(5e5, 4e6, 100, 2, 0, 0);
    for (auto& pose : moved) pose = world * pose;
    EXPECT_EQ(findFrameMismatch(lidar, moved), FrameMismatch::none);
    EXPECT_EQ(findFrameMismatch(asCamera(lidar), moved), FrameMismatch::lidarAgainstCamera);
}

// KITTI's first scans, or a robot that went across a table.
TEST(FrameCheck, ShortPathsTellAsWell) {
    for (const auto& lidar : {lidarDrive(5, 0.8), lidarDrive(20, 0.05)}) {
        const auto camera = asCamera(lidar);
        EXPECT_EQ(findFrameMismatch(lidar, lidar), FrameMismatch::none);
        EXPECT_EQ(findFrameMismatch(camera, camera), FrameMismatch::none);
        EXPECT_EQ(findFrameMismatch(camera, lidar), FrameMismatch::lidarAgainstCamera);
        EXPECT_EQ(findFrameMismatch(lidar, camera), FrameMismatch::cameraAgainstLidar);
    }
}

TEST(FrameCheck, TooLittleMotionTellsNothing) {
    const auto lidar = lidarDrive(3), camera = asCamera(lidar);
    EXPECT_EQ(findFrameMismatch(camera, lidar), FrameMismatch::unknown);
    EXPECT_EQ(findFrameMismatch(lidar, lidar), FrameMismatch::none);
    const Poses still(500, Eigen::Isometry3d::Identity());
    EXPECT_EQ(findFrameMismatch(still, still), FrameMismatch::unknown);
    EXPECT_EQ(findFrameMismatch({}, {}), FrameMismatch::unknown);
}

TEST(FrameCheck, ABadEstimateIsNotAMismatch) {
    const auto camera = asCamera(lidarDrive());
    EXPECT_EQ(findFrameMismatch(camera, Poses(camera.size(), Eigen::Isometry3d::Identity())),
              FrameMismatch::none);
    mrpt::random::CRandomGenerator random(1);
    Poses lost;
    for (std::size_t i = 0; i < camera.size(); ++i)
        lost.push_back(poseAt(random.drawGaussian1D(0, 5), random.drawGaussian1D(0, 5),
                              random.drawGaussian1D(0, 5)));
    EXPECT_EQ(findFrameMismatch(camera, lost), FrameMismatch::none);
}

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

ReportRow row(const std::string& sequence, double length_m, std::size_t segments, double t) {
    ReportRow result;
    result.name = "x";
    result.sequence = sequence;
    result.length_m = length_m;
    result.kitti.segments = segments;
    result.kitti.t_percent = t;
    result.kitti.r_deg_per_100m = t / 4;
    return result;
}

TEST(Score, TheAverageIsThePlainMeanOfTheSequences) {
    const auto average = averageOf({row("00", 4000, 3000, 1), row("04", 400, 40, 2)});
    EXPECT_EQ(average.name, "x");
    EXPECT_EQ(average.sequence, "avg");
    EXPECT_DOUBLE_EQ(average.length_m, 4400);
    EXPECT_EQ(average.kitti.segments, 3040U);
    EXPECT_DOUBLE_EQ(average.kitti.t_percent, 1.5);
    EXPECT_DOUBLE_EQ(average.kitti.r_deg_per_100m, 0.375);
}

TEST(Score, AFigureThatIsNotThereIsLeftOutOfTheAverage) {
    EXPECT_DOUBLE_EQ(averageOf({row("00", 40, 0, kNone), row("04", 400, 40, 2)}).kitti.t_percent,
                     2);
    EXPECT_TRUE(std::isnan(averageOf({row("00", 40, 0, kNone)}).kitti.t_percent));
}

/** As KITTI's official poses of 00 begin, to some millimetres: the same step again and again, then
 *  speeds that change. */
Poses kitti00(std::size_t count) {
    Poses poses;
    for (std::size_t i = 0; i < count; ++i) {
        const double t = static_cast<double>(i), late = std::max(0.0, t - 15);
        poses.push_back(poseAt(-0.0469 * t, -0.0284 * t, 0.8582 * t + 0.01 * late * late));
    }
    return poses;
}

TEST(KnownFaults, TheHeadOfKitti00IsRecognised) {
    const auto poses = kitti00(100);
    EXPECT_NE(knownFaultOf(poses).find("15 of the 100 ground-truth poses"), std::string::npos);
    EXPECT_NE(knownFaultOf({poses.begin() + 5, poses.begin() + 15}), "");  // --start, --count
}

TEST(KnownFaults, AStretchThatIsNoPartOfTheDriveToSpeakOfIsNoWarning) {
    EXPECT_EQ(knownFaultOf(kitti00(4541)), "");
    EXPECT_EQ(knownFaultOf({}), "");
}

TEST(KnownFaults, OtherDrivesAreNot) {
    const auto poses = kitti00(200);
    EXPECT_EQ(knownFaultOf({poses.begin() + 16, poses.end()}), "");
    Poses straight, slower;
    for (int i = 0; i < 16; ++i) {
        straight.push_back(poseAt(0, 0, 0.8582 * i));
        slower.push_back(poseAt(-0.04 * i, -0.025 * i, 0.78 * i));  // as odometries have it
    }
    EXPECT_EQ(knownFaultOf(straight), "");
    EXPECT_EQ(knownFaultOf(slower), "");
}
}  // namespace
