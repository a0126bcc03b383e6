#include "recordings/compensation.h"

#include <gtest/gtest.h>
#include <mrpt/maps/CSimplePointsMap.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace delio::io {
namespace {
struct Turn {
    int rings = 16, columns = 900;
    double clockwise = 1;
    double speed_ms = 0;          //!< that the recorder took out
    double offset = 0;            //!< of a ring's azimuth from the next's
    double unevenness_deg = 0.2;  //!< packets have one time for some columns
    bool told = true;             //!< rings are
};

/** A turn of 0.1 s in a yard of 24 x 16 m. */
Scan scanOf(const Turn& turn) {
    Scan scan;
    auto points = mrpt::maps::CSimplePointsMap::Create();
    for (int column = 0; column < turn.columns; ++column)
        for (int ring = 0; ring < turn.rings; ++ring) {
            const double share = static_cast<double>(column) / turn.columns;
            const double azimuth = -turn.clockwise * 2 * M_PI * share + turn.offset * ring +
                                   M_PI / 180 * turn.unevenness_deg * (column % 2);
            const double range =
                std::min(12 / std::abs(std::cos(azimuth)), 8 / std::abs(std::sin(azimuth)));
            const double elevation = M_PI / 180 * (2 * ring - 15);
            const auto time_s = static_cast<float>(0.1 * share);
            points->insertPoint(
                static_cast<float>(range * std::cos(azimuth) + turn.speed_ms * (time_s - 0.05)),
                static_cast<float>(range * std::sin(azimuth)),
                static_cast<float>(range * std::tan(elevation)));
            if (turn.told) scan.rings.push_back(static_cast<std::uint16_t>(ring));
            scan.times_s.push_back(time_s);
        }
    scan.points = points;
    return scan;
}
/** Points and times in the same new order. */
Scan reordered(const Scan& scan, const std::vector<std::size_t>& order) {
    Scan other;
    auto points = mrpt::maps::CSimplePointsMap::Create();
    for (const std::size_t i : order) {
        float x = 0, y = 0, z = 0;
        scan.points->getPointFast(i, x, y, z);
        points->insertPoint(x, y, z);
        other.times_s.push_back(scan.times_s[i]);
    }
    other.points = points;
    return other;
}

TEST(TimesFitDirections, OfEverySensorThatTurnsInWhateverOrderItsPointsAre) {
    for (const double clockwise : {1.0, -1.0}) {
        Turn turn;
        turn.clockwise = clockwise;
        turn.speed_ms = 20;
        const Scan byColumn = scanOf(turn);
        EXPECT_TRUE(timesFitDirections(byColumn));
        std::vector<std::size_t> byRing, atRandom;
        for (std::size_t ring = 0; ring < 16; ++ring)
            for (std::size_t i = ring; i < byColumn.times_s.size(); i += 16) byRing.push_back(i);
        EXPECT_TRUE(timesFitDirections(reordered(byColumn, byRing)));
        atRandom = byRing;
        std::shuffle(atRandom.begin(), atRandom.end(), std::mt19937(1));
        EXPECT_TRUE(timesFitDirections(reordered(byColumn, atRandom)));
    }
}

TEST(TimesFitDirections, NotWhereTheTimesAreThoseOfOtherPoints) {
    Scan scan = scanOf({});
    std::shuffle(scan.times_s.begin(), scan.times_s.end(), std::mt19937(1));
    EXPECT_FALSE(timesFitDirections(scan));
}
}  // namespace

TEST(Compensation, PointsAsTheyWereMeasured) {
    for (const double clockwise : {1.0, -1.0})
        for (const bool told : {true, false})
            for (const double offset : {0.0, 0.05}) {
                if (!told && offset > 0) continue;
                Turn turn;
                turn.clockwise = clockwise;
                turn.told = told;
                turn.offset = offset;
                EXPECT_EQ(isMotionCompensated(scanOf(turn)), std::optional<bool>(false))
                    << clockwise << " " << told << " " << offset;
            }
}

TEST(Compensation, PointsThatWereMoved) {
    for (const double speed_ms : {6.0, 10.0, 30.0, -15.0}) {
        Turn turn;
        turn.speed_ms = speed_ms;
        EXPECT_EQ(isMotionCompensated(scanOf(turn)), std::optional<bool>(true)) << speed_ms;
    }
}

TEST(Compensation, PointsWithoutCoordinatesOrTimesDoNotCount) {
    for (const double speed_ms : {0.0, 10.0})
        for (const bool told : {true, false}) {
            Turn turn;
            turn.speed_ms = speed_ms;
            turn.told = told;
            Scan scan = scanOf(turn);
            for (std::size_t i = 0; i < scan.points->size(); i += 5) {
                scan.points->setPoint(i, NAN, NAN, NAN);
                scan.times_s[i + 1] = NAN;
            }
            EXPECT_EQ(isMotionCompensated(scan), std::optional<bool>(speed_ms > 0)) << told;
        }
}

// Some drivers' times are not those of the lasers.
TEST(Compensation, NothingIsClaimedThatNoMotionExplains) {
    for (const bool told : {true, false}) {
        Turn turn;
        turn.told = told;
        Scan scan = scanOf(turn);
        for (std::size_t i = 0; i < scan.times_s.size(); ++i)
            scan.times_s[i] += 1e-3F * std::sin(static_cast<float>(i * 7919 % 1000));
        EXPECT_FALSE(isMotionCompensated(scan)) << told;
    }
}

TEST(Compensation, WhatDoesNotTell) {
    Scan untimed = scanOf({});
    untimed.times_s.clear();
    EXPECT_FALSE(isMotionCompensated(untimed));
    Scan few = scanOf({4, 20});
    EXPECT_FALSE(isMotionCompensated(few));
    // A camera sweeps, but nothing turns.
    Scan still = scanOf({});
    for (std::size_t i = 0; i < still.times_s.size(); ++i)
        still.times_s[i] = static_cast<float>((i * 7919) % 1000) * 1e-4F;
    EXPECT_FALSE(isMotionCompensated(still));
    EXPECT_FALSE(isMotionCompensated(scanOf({0, 0})));
}
}  // namespace delio::io
