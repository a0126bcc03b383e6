#include "delio/evaluation/relative_error.h"

#include <gtest/gtest.h>
#include <mrpt/core/bits_math.h>

#include <cmath>
#include <numeric>

#include "poses.h"

namespace {
using namespace delio::evaluation;
using delio::test::poseAt;
using Poses = std::vector<Eigen::Isometry3d>;

Poses chain(const Eigen::Isometry3d& motion, std::size_t count) {
    Poses poses = {Eigen::Isometry3d::Identity()};
    while (poses.size() < count) poses.push_back(poses.back() * motion);
    return poses;
}

TEST(RelativeError, SpreadOfAList) {
    std::vector<double> list(100);
    std::iota(list.rbegin(), list.rend(), 1);  // 100, 99, ... 1
    const auto spread = spreadOf(list);
    EXPECT_DOUBLE_EQ(spread.median, 50.5);
    EXPECT_DOUBLE_EQ(spread.p95, 95);
    EXPECT_DOUBLE_EQ(spread.max, 100);
    EXPECT_DOUBLE_EQ(spread.rmse, std::sqrt(101 * 201 / 6.0));
    EXPECT_DOUBLE_EQ(spreadOf({3}).p95, 3);
    EXPECT_DOUBLE_EQ(spreadOf({1, 9, 2}).median, 2);
    EXPECT_TRUE(std::isnan(spreadOf({}).median));
}

TEST(RelativeError, OneBadStepIsOneBadEntry) {
    const auto drive = chain(poseAt(1, 0, 0, 0.1, 0, 0), 50);
    auto estimate = drive;
    // From pose 20 on everything is displaced as a body: only the motion from 19 to 20 is wrong.
    const Eigen::Isometry3d slip = poseAt(0.3, 0.4, 0, mrpt::DEG2RAD(2.0), 0, 0);
    for (std::size_t i = 20; i < 50; ++i)
        estimate[i] = drive[20] * slip * drive[20].inverse() * drive[i];
    const auto error = relativeError(drive, estimate);
    ASSERT_EQ(error.translations_m.size(), 49U);
    for (std::size_t i = 0; i < 49; ++i) {
        EXPECT_NEAR(error.translations_m[i], i == 19 ? 0.5 : 0, 1e-10);
        EXPECT_NEAR(error.rotations_deg[i], i == 19 ? 2 : 0, 1e-10);
    }
    EXPECT_NEAR(error.translation_m.rmse, 0.5 / 7, 1e-10);
    EXPECT_NEAR(error.rotation_deg.rmse, 2.0 / 7, 1e-10);
    EXPECT_NEAR(error.translation_m.median, 0, 1e-10);
    EXPECT_NEAR(error.rotation_deg.max, 2, 1e-10);
}

TEST(RelativeError, SpansDeltaPoses) {
    const auto drive = chain(poseAt(1, 0, 0), 30), longer = chain(poseAt(1.01, 0, 0), 30);
    EXPECT_NEAR(relativeError(drive, longer, 1).translation_m.rmse, 0.01, 1e-12);
    EXPECT_NEAR(relativeError(drive, longer, 10).translation_m.rmse, 0.1, 1e-12);
    EXPECT_EQ(relativeError(drive, longer, 10).translations_m.size(), 20U);
    EXPECT_TRUE(std::isnan(relativeError(drive, longer, 30).translation_m.rmse));
    EXPECT_TRUE(std::isnan(relativeError({}, {}, 1).rotation_deg.rmse));
}
}  // namespace
