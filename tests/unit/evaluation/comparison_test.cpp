#include "delio/evaluation/comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "delio/core/error.h"
#include "poses.h"

namespace {
using namespace delio;
using evaluation::compare, evaluation::FrameMismatch;

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
              "the true poses have 27 rows but scan 27 was used");
    EXPECT_NE(messageOf(straight(1, 30), straight(3, 9), &table).find("9 poses, its table 10"),
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
    EXPECT_NE(messageOf(straight(1, 30), camera).find("estimate looks like it is in the camera"),
              std::string::npos);
}
}  // namespace
