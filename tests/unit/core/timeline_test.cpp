#include "core/timeline.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {
using delio::IntervalKind;
using delio::Timeline;

constexpr double kUsual_s = 0.1;

TEST(Timeline, BeforeTheFirstScanIsWhatIsUsual) {
    for (const double stamp_s : {0.0, -5.0, 1317354879.5}) {
        Timeline timeline;
        EXPECT_EQ(timeline.sinceStart_s(), 0);
        EXPECT_EQ(timeline.advance(stamp_s).duration_s, kUsual_s);
        EXPECT_EQ(timeline.sinceStart_s(), 0);  // the first scan is the start
    }
}

TEST(Timeline, StampsThatRiseAreBelieved) {
    Timeline timeline;
    timeline.advance(1000);
    EXPECT_EQ(timeline.advance(1000.25).duration_s, 0.25);
    EXPECT_EQ(timeline.advance(1000.5).duration_s, 0.25);
    EXPECT_EQ(timeline.advance(1001.5).duration_s, 1);  // scans are missing
    EXPECT_EQ(timeline.sinceStart_s(), 1.5);
}

TEST(Timeline, APauseOrAClockThatIsSetForwardIsNot) {
    for (const double jump_s : {1.6, 60.0, 1.3e9}) {
        Timeline timeline;
        for (int i = 0; i < 5; ++i)
            EXPECT_EQ(timeline.advance(0.25 * i).kind, IntervalKind::kUsual);
        const auto interval = timeline.advance(1 + jump_s);
        EXPECT_EQ(interval.kind, IntervalKind::kUnknown) << jump_s;
        EXPECT_EQ(interval.duration_s, 0.25);
        EXPECT_EQ(interval.elapsed_s, jump_s);
        EXPECT_EQ(timeline.sinceStart_s(), 1.25);
        EXPECT_EQ(timeline.advance(1.25 + jump_s).kind, IntervalKind::kUsual);
    }
}

// A recording of one scan in three seconds is no row of pauses.
TEST(Timeline, WhatIsUsualIsLearnt) {
    Timeline timeline;
    for (int i = 0; i < 4; ++i)
        EXPECT_EQ(timeline.advance(0.9 * i).kind, IntervalKind::kUsual) << i;
    EXPECT_EQ(timeline.advance(0.9 * 3 + 4).kind, IntervalKind::kUsual);
}

TEST(Timeline, StampsThatStandStillAreNot) {
    Timeline timeline;
    timeline.advance(7);
    for (int i = 1; i < 5; ++i) {
        EXPECT_EQ(timeline.advance(7).duration_s, kUsual_s);
        EXPECT_NEAR(timeline.sinceStart_s(), i * kUsual_s, 1e-12);
    }
    EXPECT_EQ(timeline.advance(7.5).duration_s, 0.5);
    EXPECT_NEAR(timeline.sinceStart_s(), 4 * kUsual_s + 0.5, 1e-12);
}

TEST(Timeline, AClockThatIsSetBackCountsOnFromThere) {
    Timeline timeline;
    timeline.advance(1000);
    timeline.advance(1000.5);
    const auto back = timeline.advance(3);
    EXPECT_EQ(back.duration_s, 0.5);  // what is usual here
    EXPECT_EQ(back.kind, IntervalKind::kUnknown);
    EXPECT_EQ(back.elapsed_s, 997.5);
    EXPECT_EQ(timeline.advance(3.25).duration_s, 0.25);
    EXPECT_NEAR(timeline.sinceStart_s(), 0.5 + 0.5 + 0.25, 1e-12);
}

// Two clocks that differ a little: no pause.
TEST(Timeline, AStepBackOfLessThanASecondIsNoInterruption) {
    Timeline timeline;
    timeline.advance(1000);
    timeline.advance(1000.1);
    const auto back = timeline.advance(999.5);
    EXPECT_EQ(back.kind, IntervalKind::kUsual);
    EXPECT_NEAR(back.duration_s, 0.1, 1e-9);
    EXPECT_EQ(back.elapsed_s, back.duration_s);
}

// A driver that publishes a turn twice, or topics that were merged.
TEST(Timeline, AnIntervalOfLessThanAFifthOfTheUsualOneIsShort) {
    for (const double interval_s : {2e-6, 1e-3, 0.019}) {
        Timeline timeline;
        for (int i = 0; i < 5; ++i)
            EXPECT_EQ(timeline.advance(0.1 * i).kind, IntervalKind::kUsual) << i;
        const auto early = timeline.advance(0.4 + interval_s);
        EXPECT_EQ(early.kind, IntervalKind::kShort) << interval_s;
        EXPECT_NEAR(early.duration_s, interval_s, 1e-12);
        const auto next = timeline.advance(0.5);
        EXPECT_EQ(next.kind, IntervalKind::kUsual);
        EXPECT_NEAR(next.duration_s, 0.1 - interval_s, 1e-12);
        EXPECT_NEAR(timeline.sinceStart_s(), 0.5, 1e-12);
    }
}

TEST(Timeline, ACopyWhoseStampDoesNotRiseTakesNoTime) {
    Timeline timeline;
    for (int i = 0; i < 3; ++i) timeline.advance(0.1 * i);
    for (const double stamp_s : {0.2, 0.15}) {
        const auto copy = timeline.advance(stamp_s, true);
        EXPECT_EQ(copy.kind, IntervalKind::kShort);
        EXPECT_GT(copy.duration_s, 0);
        EXPECT_LT(copy.duration_s, 1e-5);
    }
    EXPECT_EQ(timeline.advance(0.3, true).kind, IntervalKind::kUsual);
    EXPECT_NEAR(timeline.sinceStart_s(), 0.35, 1e-4);
}

TEST(Timeline, ASensorOfAHundredTurnsASecondIsNotShort) {
    Timeline timeline;
    for (int i = 0; i < 10; ++i) {
        const auto kind = timeline.advance(0.01 * i).kind;
        EXPECT_EQ(kind, i == 1 ? IntervalKind::kShort : IntervalKind::kUsual) << i;
    }
}

TEST(Timeline, TimeGoesOnWhateverTheStampsAre) {
    Timeline timeline;
    const double nan = std::nan("");
    double before_s = -1;
    for (const double stamp_s : {5.0, 5.0, 4.0, nan, nan, 4.0, 4.5, -1e9, 0.0}) {
        EXPECT_GT(timeline.advance(stamp_s).duration_s, 0);
        EXPECT_GT(timeline.sinceStart_s(), before_s);
        before_s = timeline.sinceStart_s();
    }
}
}  // namespace
