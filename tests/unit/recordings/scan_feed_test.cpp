#include "delio/recordings/scan_feed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <future>
#include <thread>
#include <vector>

#include "delio/core/error.h"

namespace delio::io {
namespace {
Scan scanOf(std::size_t index) {
    Scan scan;
    scan.index = index;
    scan.stamp_s = 0.1 * static_cast<double>(index);
    return scan;
}

ImuSample sampleAt(double stamp_s) {
    ImuSample sample;
    sample.stamp_s = stamp_s;
    return sample;
}

TEST(ScanFeed, GivesScansInOrderWithTheSamplesBeforeThem) {
    ScanFeed feed;
    feed.add(sampleAt(1));
    feed.add(sampleAt(2));
    feed.add(scanOf(0), 7.5);
    feed.add(scanOf(1));
    feed.add(sampleAt(3));
    feed.add(scanOf(2));
    feed.close();
    feed.add(scanOf(3));  // too late
    std::vector<std::size_t> samples;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto item = feed.take();
        ASSERT_TRUE(item);
        EXPECT_EQ(item->scan.index, i);
        EXPECT_EQ(item->received_s.has_value(), i == 0);
        samples.push_back(item->imu.size());
    }
    EXPECT_EQ(samples, (std::vector<std::size_t>{2, 0, 1}));
    EXPECT_FALSE(feed.take());
    EXPECT_EQ(feed.dropped(), 0U);
}

TEST(ScanFeed, DropsScansAndKeepsTheirSamples) {
    int calls = 0;
    ScanFeed feed(2, [&] { ++calls; });
    for (std::size_t i = 0; i < 5; ++i) {
        feed.add(sampleAt(static_cast<double>(i)));
        feed.add(scanOf(i));
    }
    feed.close();
    EXPECT_EQ(feed.dropped(), 3U);
    EXPECT_EQ(calls, 1);
    // The drive begins with its first scan, and the latest one is always there.
    auto item = feed.take();
    ASSERT_TRUE(item);
    EXPECT_EQ(item->scan.index, 0U);
    EXPECT_EQ(item->imu.size(), 1U);
    item = feed.take();
    ASSERT_TRUE(item);
    EXPECT_EQ(item->scan.index, 4U);
    EXPECT_EQ(item->scan.dropped, 3U);
    ASSERT_EQ(item->imu.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(item->imu[i].stamp_s, static_cast<double>(i + 1));
    EXPECT_FALSE(feed.take());
}

/** Numbers of the scans that are taken, where each one takes as long as `perScan` others need to
 *  come, and the second one `second`. */
std::vector<std::size_t> takenOf(std::size_t scans, std::size_t perScan, std::size_t second) {
    ScanFeed feed(10);
    std::vector<std::size_t> taken;
    for (std::size_t i = 0; i < scans;) {
        if (i == 0) feed.add(scanOf(i++));
        taken.push_back(feed.take()->scan.index);
        const std::size_t busy = taken.size() == 2 ? second : perScan;
        for (std::size_t end = std::min(scans, i + busy); i < end;) feed.add(scanOf(i++));
    }
    return taken;
}

std::size_t longestGapOf(const std::vector<std::size_t>& taken) {
    std::size_t longest = 0;
    for (std::size_t i = 1; i < taken.size(); ++i)
        longest = std::max(longest, taken[i] - taken[i - 1]);
    return longest;
}

TEST(ScanFeed, WhatIsTakenAfterAHiccupIsEvenInTime) {
    // While the second scan takes its time, 40 others come, of which ten may wait.
    const auto taken = takenOf(400, 1, 40);
    EXPECT_LE(longestGapOf(taken), 12U);
    // It catches up: the last hundred scans are taken one by one, shortly after they came.
    ASSERT_GT(taken.size(), 100U);
    EXPECT_EQ(longestGapOf({taken.end() - 100, taken.end()}), 1U);
    EXPECT_GE(taken.back() + 4, 399U);
}

TEST(ScanFeed, AShortHiccupCostsNoScan) { EXPECT_EQ(longestGapOf(takenOf(400, 1, 10)), 1U); }

TEST(ScanFeed, AnOdometryThatIsTooSlowGetsEvenlySpacedScans) {
    const auto taken = takenOf(400, 3, 3);
    EXPECT_LE(longestGapOf(taken), 5U);
    EXPECT_NEAR(static_cast<double>(taken.size()), 400.0 / 3, 8);
    EXPECT_GE(taken.back() + 12, 399U);
}

TEST(ScanFeed, AFaultComesAfterTheScans) {
    ScanFeed feed;
    feed.add(scanOf(0));
    feed.close(std::make_exception_ptr(Error("unplugged")));
    EXPECT_TRUE(feed.take());
    EXPECT_THROW(feed.take(), Error);
    EXPECT_FALSE(feed.take());
}

TEST(ScanFeed, SeveralThreadsMayAdd) {
    constexpr std::size_t kScans = 200, kThreads = 3;
    ScanFeed feed(kScans * kThreads);
    std::vector<std::future<void>> drivers;
    for (std::size_t t = 0; t < kThreads; ++t)
        drivers.push_back(std::async(std::launch::async, [&] {
            for (std::size_t i = 0; i < kScans; ++i) {
                feed.add(sampleAt(0));
                feed.add(scanOf(i));
            }
        }));
    std::size_t scans = 0, samples = 0;
    auto reader = std::async(std::launch::async, [&] {
        while (const auto item = feed.take()) {
            ++scans;
            samples += item->imu.size();
        }
    });
    for (auto& driver : drivers) driver.get();
    feed.close();
    reader.get();
    EXPECT_EQ(scans, kScans * kThreads);
    EXPECT_EQ(samples, kScans * kThreads);
}
}  // namespace
}  // namespace delio::io
