#include "delio/scan/rings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ring_scan.h"

namespace {
using delio::scan::ringsOf;
using delio::test::Noise;
using Rings = std::vector<std::uint16_t>;

constexpr unsigned kRings = 64;

/** 64 rings of an HDL-64E's field of view, 0 to 63, ranges as they come, 2 cm of noise. */
delio::test::RingScan hdl64() {
    Noise noise;
    return delio::test::ringScan(delio::test::yard(), Eigen::Isometry3d::Identity(),
                                 {kRings, 400, -24.8, 2, 0.02}, noise);
}

delio::test::RingScan reordered(const delio::test::RingScan& scan,
                                const std::vector<Eigen::Index>& order) {
    delio::test::RingScan result;
    result.points = scan.points(Eigen::all, order);
    for (const auto i : order) result.rings.push_back(scan.rings[static_cast<std::size_t>(i)]);
    return result;
}

std::vector<Eigen::Index> upTo(Eigen::Index count) {
    std::vector<Eigen::Index> order(static_cast<std::size_t>(count));
    std::iota(order.begin(), order.end(), 0);
    return order;
}

TEST(Rings, RingAfterRingIsTakenAsItComes) {
    const auto scan = hdl64();
    ASSERT_EQ(scan.rings.back(), kRings - 1);
    EXPECT_EQ(ringsOf(scan.points), scan.rings);
}

TEST(Rings, PointsMayBeMissing) {
    const auto scan = hdl64();
    std::vector<Eigen::Index> some;
    for (const auto i : upTo(scan.points.cols()))
        if (i % 7 != 0 && i % 11 > 3) some.push_back(i);
    const auto thinned = reordered(scan, some);
    EXPECT_EQ(ringsOf(thinned.points), thinned.rings);
}

TEST(Rings, TheSensorMayTurnClockwise) {
    auto scan = hdl64();
    scan.points.row(1) *= -1;
    EXPECT_EQ(ringsOf(scan.points), scan.rings);
}

TEST(Rings, TheLowestRingMayComeFirst) {
    const auto scan = hdl64();
    auto order = upTo(scan.points.cols());
    std::reverse(order.begin(), order.end());
    auto expected = reordered(scan, order);
    for (auto& ring : expected.rings) ring = static_cast<std::uint16_t>(kRings - 1 - ring);
    EXPECT_EQ(ringsOf(expected.points), expected.rings);
}

TEST(Rings, AnotherOrderFallsBackToElevation) {
    const auto scan = hdl64();
    auto order = upTo(scan.points.cols());
    std::shuffle(order.begin(), order.end(), std::mt19937(1));  // any order will do
    const auto shuffled = reordered(scan, order);
    const Rings found = ringsOf(shuffled.points);
    ASSERT_EQ(found.size(), shuffled.rings.size());
    // 64 equal steps over the field of view: rings that are 26.8/63 deg apart get their own step
    // each but for those at a step's border, so no point is off by more than one.
    for (std::size_t i = 0; i < found.size(); ++i)
        EXPECT_LE(std::abs(found[i] - shuffled.rings[i]), 1);
    EXPECT_EQ(*std::max_element(found.begin(), found.end()), kRings - 1);
    EXPECT_EQ(*std::min_element(found.begin(), found.end()), 0);
}

// 16 bits would run over, and what counts the points of a ring would have too few places.
TEST(Rings, AnyNumberOfHalfTurnsIsNoHarm) {
    for (const int rounds : {300, 65540, 65700, 131100}) {
        Eigen::Matrix3Xf points(3, rounds);
        for (int i = 0; i < rounds; ++i)
            points.col(i) << 10, (i % 2 == 0 ? 0.1F : -0.1F), static_cast<float>(i % 50) * 0.1F;
        const Rings found = ringsOf(points);
        ASSERT_EQ(found.size(), static_cast<std::size_t>(rounds));
        EXPECT_LT(*std::max_element(found.begin(), found.end()), 64);
        for (int i = 1; i < 50; ++i)
            EXPECT_LE(found[static_cast<std::size_t>(i)], found[static_cast<std::size_t>(i) - 1]);
    }
}

TEST(Rings, FewPointsAreFine) {
    EXPECT_TRUE(ringsOf({}).empty());
    EXPECT_EQ(ringsOf(Eigen::Vector3f(3, 4, 5)), Rings{0});
    EXPECT_EQ(ringsOf(Eigen::Vector3f(0, 0, 0)), Rings{0});
    Eigen::Matrix3Xf two(3, 2);
    two << 10, 10, 0, 0, 1, -1;
    EXPECT_EQ(ringsOf(two), (Rings{0, 63}));
}

TEST(Rings, AreNumberedFromTheTop) {
    Eigen::Matrix3Xf points(3, 4);
    points << 10, 10, 10, 10, 0, 0, 0, 0, -1, 2, 0, 2.1F;
    EXPECT_EQ(delio::scan::ringsFromTop(points, {0, 1, 7, 1}),
              (std::vector<std::uint16_t>{2, 0, 1, 0}));
    EXPECT_TRUE(delio::scan::ringsFromTop({}, {}).empty());
}
}  // namespace
