#include "places/closure.h"

#include <gtest/gtest.h>

#include <vector>

#include "poses.h"

namespace {
using namespace delio;
using places::FreeSpace;
using places::HeightImage;

/** DenseSubmap of 20 m by 20 m, and across it a wall of 4 m. */
Eigen::Matrix3Xf withWallAt(float x) {
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 80; ++i) {
        const float y = 0.1F + 0.25F * static_cast<float>(i);
        for (int k = 0; k < 80; ++k)
            points.emplace_back(0.1F + 0.25F * static_cast<float>(k), y, 0.0F);
        for (int k = 0; k < 16; ++k)
            points.emplace_back(x, y, 0.1F + 0.25F * static_cast<float>(k));
    }
    Eigen::Matrix3Xf cloud(3, static_cast<Eigen::Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i)
        cloud.col(static_cast<Eigen::Index>(i)) = points[i];
    return cloud;
}

TEST(FreeSpace, IsBuiltOnByWallsThatStandElsewhere) {
    const auto points = withWallAt(5.2F);
    const HeightImage here(points), there(withWallAt(9.2F));
    const FreeSpace free(here, points);
    EXPECT_EQ(free.conflict(here, test::poseAt(0, 0, 0)), 0);
    EXPECT_EQ(free.conflict(there, test::poseAt(0, 0, 0)), 1);
    EXPECT_EQ(free.conflict(there, test::poseAt(-4, 0, 0)), 0);
    EXPECT_EQ(free.conflict(there, test::poseAt(100, 0, 0)), 0);  // nothing to compare
}

TEST(FreeSpace, OfNothingIsNotBuiltOn) {
    const Eigen::Matrix3Xf nothing(3, 0);
    const HeightImage none(nothing), wall(withWallAt(5));
    EXPECT_EQ(FreeSpace(none, nothing).conflict(wall, test::poseAt(0, 0, 0)), 0);
    EXPECT_EQ(FreeSpace(none, nothing).conflict(none, test::poseAt(0, 0, 0)), 0);
}
}  // namespace
