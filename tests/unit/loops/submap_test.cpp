#include "delio/loops/submap.h"

#include <gtest/gtest.h>

#include "poses.h"

namespace {
using namespace delio;
using loops::Submap;
using loops::SubmapBuilder;
using test::poseAt;
using test::poseAtDeg;

const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();

Eigen::Matrix3Xf post() { return Eigen::Vector3f(3, 1, 0.5F); }

std::vector<Submap> driven(const std::vector<Eigen::Isometry3d>& poses) {
    SubmapBuilder builder{{}};
    for (std::size_t i = 0; i < poses.size(); ++i) builder.add(i, poses[i], post(), kUp);
    return builder.finish();
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
    EXPECT_NEAR(submaps[1].path_m, static_cast<double>(submaps[1].key), 1e-9);
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
    SubmapBuilder builder{{}};
    // Mounted on its side: what is up is to the left.
    for (std::size_t i = 0; i < 3; ++i)
        builder.add(i, poseAt(0, 0, 0), Eigen::Vector3f(4, 2, 0), Eigen::Vector3d::UnitY());
    const auto submap = builder.finish().at(0);
    ASSERT_EQ(submap.points.cols(), 1);
    EXPECT_NEAR(submap.points(2, 0), 2, 1e-5);
    EXPECT_LT(
        (submap.level * submap.points.col(0).cast<double>() - Eigen::Vector3d(4, 2, 0)).norm(),
        1e-5);
}

TEST(SubmapBuilder, LeavesOutWhatIsFar) {
    SubmapBuilder builder{{}};
    builder.add(0, poseAt(0, 0, 0), Eigen::Vector3f(51, 0, 0), kUp);
    EXPECT_EQ(builder.finish().at(0).points.cols(), 0);
}

TEST(SubmapBuilder, TakesBackTheLatest) {
    SubmapBuilder builder{{}};
    const auto drive = [&](int from, int to) {
        for (int i = from; i < to; ++i)
            builder.add(static_cast<std::size_t>(i), poseAt(i, 0, 0), post(), kUp);
    };
    drive(0, 26);
    builder.add(26, poseAt(500, 0, 0), post(), kUp);  // begins the second, and is taken back
    builder.undo();
    drive(26, 40);
    const auto submaps = builder.finish();
    ASSERT_EQ(submaps.size(), 2U);
    EXPECT_EQ(submaps[1].first, 26U);
    EXPECT_NEAR(submaps[1].path_m, static_cast<double>(submaps[1].key), 1e-9);
}

TEST(SubmapBuilder, OfNothingHasNone) { EXPECT_TRUE(SubmapBuilder{{}}.finish().empty()); }
}  // namespace
