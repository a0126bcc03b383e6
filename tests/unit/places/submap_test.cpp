#include "delio/places/submap.h"

#include <gtest/gtest.h>

#include <cmath>

#include "poses.h"

namespace {
using namespace delio;
using places::Submap;
using places::SubmapBuilder;
using test::poseAt;
using test::poseAtDeg;

const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();

Eigen::Matrix3Xf post() { return Eigen::Vector3f(3, 1, 0.5F); }

/** A builder and what it has made, driven by poses. */
struct Drive {
    SubmapBuilder builder{{}};
    std::vector<Submap> submaps;
    std::vector<Eigen::Isometry3d> poses;

    void take(std::future<Submap> ended) {
        if (ended.valid()) submaps.push_back(ended.get());
    }
    void add(const Eigen::Isometry3d& pose, const Eigen::Matrix3Xf& points = post(),
             const Eigen::Vector3d& up = kUp) {
        const Increment step{poses.empty() ? pose : poses.back().inverse() * pose,
                             1e-6 * Matrix6::Identity()};
        take(builder.add(poses.size(), step, points, up));
        poses.push_back(pose);
    }
    std::vector<Submap> finish() {
        take(builder.finish());
        return submaps;
    }
};

std::vector<Submap> driven(const std::vector<Eigen::Isometry3d>& poses) {
    Drive drive;
    for (const auto& pose : poses) drive.add(pose);
    return drive.finish();
}

/** A floor about the sensor of so many points on each side, 0.05 m apart. */
Eigen::Matrix3Xf floorOf(int side) {
    Eigen::Matrix3Xf points(3, side * side);
    for (int i = 0; i < side * side; ++i)
        points.col(i) << static_cast<float>(i % side - side / 2),
            static_cast<float>(i / side - side / 2), -20;
    return 0.05F * points;
}

// 10 m by 10 m at half the spacing. 60 m by 60 m have enough points at the spacing.
TEST(SubmapBuilder, KeepsMorePointsOfASmallRoom) {
    const double spacing = places::SubmapOptions().spacing;
    const auto pointsOf = [](int side) {
        Drive drive;
        drive.add(poseAt(0, 0, 0), floorOf(side));
        return static_cast<double>(drive.finish().at(0).points.cols());
    };
    EXPECT_NEAR(pointsOf(200), std::pow(10 / (spacing / 2), 2), 300);
    EXPECT_NEAR(pointsOf(1200), std::pow(60 / spacing, 2), 1000);
}

TEST(SubmapBuilder, CutsAStraightDriveBy25m) {
    std::vector<Eigen::Isometry3d> poses;
    for (int i = 0; i <= 60; ++i) poses.push_back(poseAt(i, 0, 0));
    const auto submaps = driven(poses);
    ASSERT_EQ(submaps.size(), 3U);
    EXPECT_EQ(submaps[0].first, 0U);
    EXPECT_EQ(submaps[0].last, 25U);
    EXPECT_EQ(submaps[1].first, 26U);
    EXPECT_EQ(submaps[2].last, 60U);
    EXPECT_NEAR(submaps[1].driven.path_m, static_cast<double>(submaps[1].key), 1e-9);
}

// A loop of 60 m never is 25 m from where it began.
TEST(SubmapBuilder, CutsARoundDriveBy50mOfPath) {
    std::vector<Eigen::Isometry3d> poses{poseAt(0, 0, 0)};
    for (int i = 0; i < 60; ++i) poses.push_back(poses.back() * poseAtDeg(1.01, 0, 0, 6));
    const auto submaps = driven(poses);
    ASSERT_EQ(submaps.size(), 2U);
    EXPECT_EQ(submaps[0].last, 50U);
}

TEST(SubmapBuilder, ThinsAndTurnsTheLevelUp) {
    Drive drive;
    // Mounted on its side: what is up is to the left.
    for (int i = 0; i < 3; ++i)
        drive.add(poseAt(i, 0, 0), Eigen::Vector3f(4.0F - static_cast<float>(i), 2, 0),
                  Eigen::Vector3d::UnitY());
    const auto submap = drive.finish().at(0);
    ASSERT_EQ(submap.points.cols(), 1);
    EXPECT_NEAR(submap.points(2, 0), 2, 1e-5);
    EXPECT_LT(
        (submap.level * submap.points.col(0).cast<double>() - Eigen::Vector3d(3, 2, 0)).norm(),
        1e-5);
}

TEST(SubmapBuilder, LeavesOutWhatIsFar) {
    Drive drive;
    drive.add(poseAt(0, 0, 0), Eigen::Vector3f(51, 0, 0));
    EXPECT_EQ(drive.finish().at(0).points.cols(), 0);
}

// An hour of standing still, with its noise, is no path, and takes no memory.
TEST(SubmapBuilder, OfAStandstillKeepsOneScan) {
    Drive drive;
    for (int i = 0; i < 2000; ++i)
        drive.add(poseAt(i % 2 ? 0.05 : 0, 0, 0), Eigen::Vector3f(static_cast<float>(i), 1, 0));
    drive.add(poseAt(3, 0, 0));
    const auto submaps = drive.finish();
    ASSERT_EQ(submaps.size(), 1U);
    EXPECT_LE(submaps[0].driven.path_m, 0.1);
    EXPECT_EQ(submaps[0].points.cols(), 2);
    EXPECT_NEAR(submaps[0].driven.variance_m2, 1e-3, 1e-5);
}

// What was seen after a pause does not hang together with what was seen before it.
TEST(SubmapBuilder, CutsAtAGap) {
    SubmapBuilder builder{{}};
    const Increment step{poseAt(1, 0, 0), 1e-6 * Matrix6::Identity()},
        gap{poseAt(1, 0, 0), 9 * Matrix6::Identity()};
    for (std::size_t i = 0; i < 5; ++i) EXPECT_FALSE(builder.add(i, step, post(), kUp).valid());
    auto before = builder.add(5, gap, post(), kUp);
    ASSERT_TRUE(before.valid());
    EXPECT_FALSE(builder.add(6, step, post(), kUp).valid());
    EXPECT_EQ(before.get().last, 4U);  // whatever came meanwhile
    auto after = builder.finish();
    ASSERT_TRUE(after.valid());
    const Submap second = after.get();
    EXPECT_EQ(second.first, 5U);
    EXPECT_GT(second.driven.variance_m2, 9);
}

TEST(SubmapBuilder, OfNothingHasNone) { EXPECT_FALSE(SubmapBuilder{{}}.finish().valid()); }
}  // namespace
