#include "start.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drive.h"
#include "scene_support.h"

namespace {
using namespace delio;
using namespace delio::synth;

constexpr std::size_t kScans = 60;

/** Metres from scan `scan` to the next. */
double step(const Drive& drive, std::size_t scan) {
    return drive.station(scan + 1) - drive.station(scan);
}

bool stands(const Drive& drive) { return step(drive, 0) < 0.1; }

TEST(SynthStart, FromRestItGoesTheSameWaySlowedAtItsBeginning) {
    for (const std::uint64_t seed : {1U, 2U}) {
        const auto scene = test::sceneOf("highway", seed, kScans);
        const Drive asSeeded(scene->road(), kScans, seed);
        const Drive drive(scene->road(), kScans, seed, Gait::kVehicle, Start::kRest);
        ASSERT_FALSE(stands(asSeeded));
        EXPECT_TRUE(stands(drive));
        EXPECT_EQ(drive.scans(), kScans);
        EXPECT_EQ(drive.stationAt(-0.05), drive.station(0));
        for (const std::size_t scan : {20U, 40U, 59U})  // a second is lost
            EXPECT_TRUE(drive.lidarPose(scan).isApprox(asSeeded.lidarPose(scan - 10), 1e-9));
        for (std::size_t scan = 1; scan < 20; ++scan) EXPECT_GT(step(drive, scan), step(drive, 0));
        EXPECT_NEAR(drive.station(10), asSeeded.stationAt(0.25), 1e-9);
    }
}

TEST(SynthStart, MovingItBeginsWhereItIsFast) {
    for (const std::string name : {"urban", "rural", "loop"})
        for (std::uint64_t seed = 1; seed < 6; ++seed) {
            const auto scans = kScans + scansBefore(Start::kMoving);
            const auto scene = test::sceneOf(name, seed, scans);
            const Drive asSeeded(scene->road(), scans, seed);
            const Drive drive(scene->road(), kScans, seed, Gait::kVehicle, Start::kMoving);
            EXPECT_EQ(drive.scans(), kScans);
            if (!stands(asSeeded)) {
                EXPECT_EQ(drive.station(0), 0);
                continue;
            }
            double fastest = 0;
            for (std::size_t i = 0; i < 360; ++i) fastest = std::max(fastest, step(asSeeded, i));
            EXPECT_GE(step(drive, 0), 0.9 * fastest) << name << " " << seed;
            EXPECT_GT(drive.station(0), 5);
        }
}

TEST(SynthStart, WhatBeginsAsAskedStaysAsItIs) {
    for (std::uint64_t seed = 1; seed < 8; ++seed) {
        const auto scene = test::sceneOf("urban", seed, kScans);
        const Drive asSeeded(scene->road(), kScans, seed);
        const Drive asked(scene->road(), kScans, seed, Gait::kVehicle,
                          stands(asSeeded) ? Start::kRest : Start::kMoving);
        EXPECT_TRUE(asked.lidarPose(50).matrix() == asSeeded.lidarPose(50).matrix());
    }
}

TEST(SynthStart, ALongerWorldBeginsLikeAShorterOne) {
    for (const auto& name : sceneNames()) {
        const auto scene = test::sceneOf(name, 3, kScans), longer = test::sceneOf(name, 3, 420);
        const Drive a(scene->road(), kScans, 3), b(longer->road(), kScans, 3);
        EXPECT_TRUE(a.lidarPose(59).isApprox(b.lidarPose(59), 1e-9)) << name;
    }
}
}  // namespace
