#include "recordings/turn_builder.h"

#include <gtest/gtest.h>

#include <cmath>

#include "delio/core/error.h"

namespace {
using namespace delio;
using io::TurnBuilder;

/** Blocks from one azimuth (turns, any number of them) to another, a point in each, 0.1 s a turn.
 */
void addTurns(TurnBuilder& builder, double from, double to, double begin_s = 100,
              double step = 0.001) {
    const auto blocks = static_cast<int>(std::lround(std::abs(to - from) / step));
    for (int i = 0; i < blocks; ++i) {
        const double turned = from + (to - from) * (i + 0.5) / blocks;
        builder.block(turned - std::floor(turned), begin_s + 0.1 * std::abs(turned - from));
        builder.add({static_cast<float>(turned), 0, 0, 0, 0, 0});
    }
}

std::vector<std::size_t> sizesOf(TurnBuilder& builder) {
    builder.finish("Toy");
    std::vector<std::size_t> sizes;
    while (const auto scan = builder.take()) sizes.push_back(scan->points->size());
    return sizes;
}

using Sizes = std::vector<std::size_t>;

TEST(TurnBuilder, TurnsBeginAtZeroInEitherSense) {
    TurnBuilder forward, back;
    addTurns(forward, 0.3, 3.6);
    EXPECT_EQ(sizesOf(forward), Sizes({700, 1000, 1000, 600}));
    addTurns(back, 0.7, -2.6);
    EXPECT_EQ(sizesOf(back), Sizes({710, 1000, 1000, 590}));  // a jitter of 0.01 turns is allowed
}

TEST(TurnBuilder, LessThanHalfATurnIsNoScan) {
    TurnBuilder builder;
    addTurns(builder, 0.6, 2.4);
    EXPECT_EQ(sizesOf(builder), Sizes({1000}));
    TurnBuilder small;
    addTurns(small, 0.6, 0.7);
    try {
        sizesOf(small);
        ADD_FAILURE();
    } catch (const Error& e) {
        EXPECT_STREQ(e.what(),
                     "only 35 of 360 degrees in 100 blocks of a Toy; a scan needs at least half a "
                     "revolution");
    }
    TurnBuilder none;
    EXPECT_TRUE(sizesOf(none).empty());
}

TEST(TurnBuilder, ShakingIsNoTurn) {
    TurnBuilder builder;
    for (int i = 0; i < 1000; ++i) {
        builder.block(i % 2 == 0 ? 0.999 : 0.001, 100 + 1e-4 * i);
        builder.add({});
    }
    EXPECT_THROW(builder.finish("Toy"), Error);
    EXPECT_FALSE(builder.take());
}

TEST(TurnBuilder, StampIsTheFirstPointsTime) {
    TurnBuilder builder;
    for (int i = 0; i < 1000; ++i) {
        builder.block(0.001 * i, 100 + 1e-4 * i);
        if (i >= 20) builder.add({1, 2, 3, 0.5F, 7, 2e-5F});
    }
    builder.finish("Toy");
    const auto scan = builder.take();
    ASSERT_TRUE(scan);
    EXPECT_NEAR(scan->stamp_s, 100.00202, 1e-9);
    EXPECT_EQ(scan->times_s.front(), 0);
    EXPECT_NEAR(scan->times_s.back(), 979e-4, 1e-7);
    EXPECT_EQ(scan->rings.front(), 7);
}

TEST(TurnBuilder, GapsEndATurn) {
    TurnBuilder builder;
    addTurns(builder, 0, 1.8);
    addTurns(builder, 1.8, 4.6, 105);
    // What there is of a turn before and behind the gap is 0.8 and 0.2 of one.
    EXPECT_EQ(sizesOf(builder), Sizes({1000, 800, 1000, 1000, 600}));
}

TEST(TurnBuilder, WrongTimesAreMended) {
    TurnBuilder builder;
    for (int i = 0; i < 1000; ++i) {
        builder.block(0.001 * i, 100 + 1e-4 * i + (i == 500 ? 0.34 : 0));
        builder.add({});
    }
    builder.finish("Toy");
    const auto scan = builder.take();
    EXPECT_NEAR(scan.value().times_s[500], 0.05, 1e-6);
    ASSERT_EQ(builder.findings().size(), 1U);
    EXPECT_EQ(builder.findings()[0],
              "interpolated the times of 1 block (first in scan 0), which lay outside their "
              "revolution");
}
}  // namespace
