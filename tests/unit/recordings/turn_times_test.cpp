#include "recordings/turn_times.h"

#include <gtest/gtest.h>

#include <random>

namespace {
using delio::io::mendTurnTimes;
constexpr double kTolerance = 0.02;

/** A turn of 0.1 s in even parts, with the jitter of a real sensor. */
struct Turn {
    explicit Turn(std::size_t parts) {
        std::mt19937 random(5);
        std::uniform_real_distribution<double> jitter_s(-1e-5, 1e-5);
        for (std::size_t i = 0; i < parts; ++i) {
            places.push_back(static_cast<double>(i) / static_cast<double>(parts));
            times_s.push_back(0.1 * places.back() + jitter_s(random));
        }
    }

    std::vector<double> places, times_s;
};

void expectNear(const std::vector<double>& times_s, const Turn& turn) {
    ASSERT_EQ(times_s.size(), turn.times_s.size());
    for (std::size_t i = 0; i < times_s.size(); ++i)
        ASSERT_NEAR(times_s[i], turn.times_s[i], 1e-4) << i;
}

TEST(TurnTimes, RightOnesStay) {
    for (const std::size_t parts : {2U, 3U, 16U, 75U, 1024U}) {
        const Turn turn(parts);
        auto times_s = turn.times_s;
        EXPECT_EQ(mendTurnTimes(turn.places, kTolerance, times_s), std::optional<std::size_t>(0));
        EXPECT_EQ(times_s, turn.times_s);
    }
}

TEST(TurnTimes, WrongOnesAreInterpolated) {
    const Turn turn(512);
    for (const double wrong_s : {-1.7e9, -0.05, 0.03, 9e9}) {
        auto times_s = turn.times_s;
        for (const std::size_t i : {0U, 1U, 100U, 101U, 102U, 300U, 511U}) times_s[i] += wrong_s;
        EXPECT_EQ(mendTurnTimes(turn.places, kTolerance, times_s), std::optional<std::size_t>(7));
        expectNear(times_s, turn);
    }
    auto times_s = turn.times_s;  // a fifth of the turn at once
    for (std::size_t i = 50; i < 150; ++i) times_s[i] = 0;
    EXPECT_GT(mendTurnTimes(turn.places, kTolerance, times_s), std::optional<std::size_t>(90));
    for (std::size_t i = 0; i < 512; ++i) EXPECT_NEAR(times_s[i], turn.times_s[i], 2.1e-3);
}

TEST(TurnTimes, TurnsMayBeMissing) {
    Turn turn(75);
    for (std::size_t i = 40; i < 75; ++i) turn.times_s[i] += 0.3;
    auto times_s = turn.times_s;
    EXPECT_EQ(mendTurnTimes(turn.places, kTolerance, times_s), std::optional<std::size_t>(0));
    EXPECT_EQ(times_s, turn.times_s);
    for (std::size_t i = 40; i < 75; ++i) turn.times_s[i] += 2;
    times_s = turn.times_s;
    EXPECT_EQ(mendTurnTimes(turn.places, kTolerance, times_s), std::optional<std::size_t>(35));
    EXPECT_LT(times_s.back(), 0.101);
}

TEST(TurnTimes, TooManyWrongOnesAreOfNoUse) {
    const Turn turn(512);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> anything_s(-1e9, 1e9);
    auto times_s = turn.times_s;
    for (double& time_s : times_s) time_s = anything_s(random);
    EXPECT_FALSE(mendTurnTimes(turn.places, kTolerance, times_s));
    times_s.assign(512, 7);
    EXPECT_FALSE(mendTurnTimes(turn.places, kTolerance, times_s));
}

TEST(TurnTimes, NothingTurns) {
    std::vector<double> times_s{1, 2, 5};
    EXPECT_EQ(mendTurnTimes({0, 0, 0}, kTolerance, times_s), std::optional<std::size_t>(0));
    times_s = {3};
    EXPECT_EQ(mendTurnTimes({0}, kTolerance, times_s), std::optional<std::size_t>(0));
    times_s.clear();
    EXPECT_EQ(mendTurnTimes({}, kTolerance, times_s), std::optional<std::size_t>(0));
}
}  // namespace
