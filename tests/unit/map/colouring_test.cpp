#include "delio/map/colouring.h"

#include <gtest/gtest.h>

#include <cmath>

#include "delio/core/error.h"
#include "point_support.h"

namespace {
using namespace delio;
using map::ColourBy;
using test::pointAt;

/** A row of points whose every value rises from 0 to 100. */
map::MapPoints ramp() {
    map::MapPoints points;
    for (int i = 0; i <= 100; ++i) {
        auto point = pointAt(0.01 * i, 0, 0);
        point.intensity = point.time_s = point.residual_m = static_cast<float>(i);
        point.observations = static_cast<std::uint16_t>(i);
        points.push_back(point);
    }
    return points;
}

TEST(Colouring, LaysTheColourMapBetweenRobustLimits) {
    for (const auto by :
         {ColourBy::Intensity, ColourBy::Time, ColourBy::Residual, ColourBy::Observations}) {
        const auto colours = map::coloursOf(ramp(), {by, map::Colormap::Viridis});
        ASSERT_EQ(colours.ofPoints.size(), 101U);
        ASSERT_TRUE(colours.range);
        EXPECT_EQ(colours.range->low, 2);
        EXPECT_EQ(colours.range->high, 98);
        for (int i = 0; i <= 100; ++i)
            EXPECT_EQ(colours.ofPoints[static_cast<std::size_t>(i)],
                      map::colourAt(map::Colormap::Viridis, (i - 2) / 96.0));
    }
}

TEST(Colouring, NormalsAreColoursOfTheirOwn) {
    map::MapPoints points(4);
    points[0].normal = {1, 0, 0};
    points[1].normal = {0, -1, 0};
    points[2].normal = {0, 0.5F, -0.5F};
    const auto colours = map::coloursOf(points, {ColourBy::Normal});
    EXPECT_FALSE(colours.range);
    using mrpt::img::TColor;
    EXPECT_EQ(colours.ofPoints[0], TColor(255, 128, 128));
    EXPECT_EQ(colours.ofPoints[1], TColor(128, 0, 128));
    EXPECT_EQ(colours.ofPoints[2], TColor(128, 191, 64));
    EXPECT_EQ(colours.ofPoints[3], TColor(128, 128, 128));
}

TEST(Colouring, HeightIsAboveTheGroundAround) {
    // Two places of the same shape, one 50 m above the other.
    map::MapPoints points;
    for (const double x : {0.0, 500.0})
        for (int i = 0; i < 200; ++i)
            points.push_back(pointAt(x + 0.01 * i, 0, x / 10 + 0.02 * std::max(0, i - 100)));
    const auto colours = map::coloursOf(points);
    for (std::size_t i = 0; i < 200; ++i)
        EXPECT_EQ(colours.ofPoints[i], colours.ofPoints[i + 200]) << i;
    EXPECT_NE(colours.ofPoints[0], colours.ofPoints[199]);
    EXPECT_EQ(colours.unit, " m");
}

TEST(Colouring, WhatPointsDoNotHaveIsAnError) {
    const map::MapPoints bare(3);
    for (const auto& name : map::colourByNames()) {
        const auto by = map::colourByNamed(name);
        EXPECT_EQ(map::coloursOf({}, {by}).ofPoints.size(), 0U) << name;
        if (by == ColourBy::Height) continue;
        try {
            map::coloursOf(bare, {by});
            ADD_FAILURE() << name;
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find(name), std::string::npos) << e.what();
        }
    }
    EXPECT_EQ(map::coloursOf(bare).ofPoints.size(), 3U);
    EXPECT_THROW(map::colourByNamed("taste"), Error);
}

TEST(Colormap, RobustRangeIgnoresStrays) {
    std::vector<float> values;
    for (int i = 0; i <= 1000; ++i) values.push_back(static_cast<float>(i));
    values.push_back(1e9F);
    values.push_back(std::nanf(""));
    const auto range = map::robustRange(values);
    EXPECT_NEAR(range.low, 20, 1);
    EXPECT_NEAR(range.high, 980, 1);
    EXPECT_GT(map::robustRange({5, 5, 5}).high, map::robustRange({5, 5, 5}).low);
    EXPECT_EQ(map::robustRange({}).high, 1);
    EXPECT_THROW(map::colormapNamed("jet"), Error);
    for (const auto& name : map::colormapNames()) EXPECT_NO_THROW(map::colormapNamed(name));
}
}  // namespace
