#include "delio/evaluation/segment_curves.h"

#include <gtest/gtest.h>

#include "poses.h"

namespace {
using namespace delio::evaluation;

/** A pose every 0.1 s at a constant speed; the estimate is `percent` too long. */
Comparison drive(double speed_mps, double percent, std::size_t poses) {
    Comparison comparison;
    for (std::size_t i = 0; i < poses; ++i) {
        const double x = 0.1 * speed_mps * static_cast<double>(i);
        comparison.reference.push_back(delio::test::poseAt(x, 0, 0));
        comparison.estimate.push_back(delio::test::poseAt(x * (1 + percent / 100), 0, 0));
        comparison.times_s.push_back(0.1 * static_cast<double>(i));
    }
    comparison.row = score(comparison.reference, comparison.estimate, {50, 100}, 1);
    return comparison;
}

TEST(SegmentCurves, OverLengthAllSegmentsOfALengthCount) {
    const auto slow = drive(7, 1, 400), fast = drive(13, 3, 400);
    const auto curve = errorOverLength({&slow, &fast});
    ASSERT_EQ(curve.size(), 2U);
    EXPECT_DOUBLE_EQ(curve[0].at, 50);
    EXPECT_DOUBLE_EQ(curve[1].at, 100);
    const auto& a = slow.row.kitti.perLength[0];
    const auto& b = fast.row.kitti.perLength[0];
    const auto n = static_cast<double>(a.segments), m = static_cast<double>(b.segments);
    EXPECT_NEAR(curve[0].t_percent, (a.t_percent * n + b.t_percent * m) / (n + m), 1e-9);
    EXPECT_NEAR(curve[0].r_deg_per_100m, 0, 1e-9);
}

TEST(SegmentCurves, OverSpeedNeighboursShareSegments) {
    const auto slow = drive(7, 1, 400), fast = drive(13, 3, 400);
    // At nearly 7 m/s: the points 6 and 8; at nearly 13 m/s: 12 and 14.
    const auto curve = errorOverSpeed({&slow, &fast});
    ASSERT_EQ(curve.size(), 4U);
    const double kmh[] = {6 * 3.6, 8 * 3.6, 12 * 3.6, 14 * 3.6};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_DOUBLE_EQ(curve[i].at, kmh[i]);
        EXPECT_NEAR(curve[i].t_percent, i < 2 ? 1 : 3, 0.1);
    }
}

TEST(SegmentCurves, FewerThanThreeSegmentsMakeNoPoint) {
    const auto brief = drive(10, 1, 115);  // two segments of 100 m, seven of 50 m
    ASSERT_EQ(brief.row.kitti.perLength[1].segments, 2U);
    const auto curve = errorOverLength({&brief});
    ASSERT_EQ(curve.size(), 1U);
    EXPECT_DOUBLE_EQ(curve[0].at, 50);
    EXPECT_TRUE(errorOverLength({}).empty());
}

TEST(SegmentCurves, StampsThatCoincideHaveNoSpeed) {
    auto comparison = drive(10, 1, 400);
    for (auto& t : comparison.times_s) t = 5;
    EXPECT_TRUE(errorOverSpeed({&comparison}).empty());
}
}  // namespace
