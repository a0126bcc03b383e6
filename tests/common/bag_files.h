#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "bag_writers.h"
#include "delio/core/error.h"
#include "recordings/sources.h"
#include "test_data.h"

/** Bags to be read in tests. */
namespace delio::bag_test {
using test::BagContents;
using test::CloudSpec;
using test::Index;
using Kind = test::WireWriter::Kind;

constexpr double kBegin_s = 1700000000;

inline std::string plainText(const std::string& text, Kind kind = Kind::kRos1) {
    return test::WireWriter(kind).text(text).message();
}

/** `scans` clouds of /points ten times a second, and a message of /chatter after each. */
inline BagContents drive(int scans, Kind kind = Kind::kRos1, std::uint32_t points = 20) {
    const bool ros1 = kind == Kind::kRos1;
    BagContents bag;
    bag.encoding = ros1 ? "ros1" : "cdr";
    bag.topics = {{"/points", ros1 ? "sensor_msgs/PointCloud2" : "sensor_msgs/msg/PointCloud2"},
                  {"/chatter", ros1 ? "std_msgs/String" : "std_msgs/msg/String"}};
    for (int i = 0; i < scans; ++i) {
        CloudSpec cloud;
        cloud.scan = i;
        cloud.columns = points;
        cloud.stamp_s = kBegin_s + 0.1 * i;
        bag.messages.push_back({0, cloud.stamp_s + 0.01, cloudMessage(cloud, kind)});
        bag.messages.push_back({1, cloud.stamp_s + 0.02, plainText("on we go", kind)});
    }
    return bag;
}

/** A way to store a bag, and to read it. */
struct Container {
    const char* name;
    const char* file;
    Kind kind;
    void (*write)(const std::filesystem::path&, const BagContents&);
    std::unique_ptr<io::ScanReader> (*open)(const io::ScanSource&);
};

inline std::vector<Container> containers() {
    using Path = const std::filesystem::path&;
    using Bag = const BagContents&;
    const auto ros1 = io::openRos1Bag;
    const auto mcap = io::openMcap;
    return {
        {"bag", "d.bag", Kind::kRos1, [](Path p, Bag b) { writeRos1Bag(p, b); }, ros1},
        {"bag, bz2", "d.bag", Kind::kRos1, [](Path p, Bag b) { writeRos1Bag(p, b, "bz2"); }, ros1},
        {"bag, lz4", "d.bag", Kind::kRos1, [](Path p, Bag b) { writeRos1Bag(p, b, "lz4"); }, ros1},
        {"bag, no index", "d.bag", Kind::kRos1,
         [](Path p, Bag b) { writeRos1Bag(p, b, "none", Index::kNever); }, ros1},
        {"db3", "d.db3", Kind::kCdr, [](Path p, Bag b) { test::writeDatabase(p, b); },
         io::openRos2Database},
        {"mcap, ros1", "d.mcap", Kind::kRos1, [](Path p, Bag b) { writeMcap(p, b); }, mcap},
        {"mcap, no chunks", "d.mcap", Kind::kCdr,
         [](Path p, Bag b) { writeMcap(p, b, "", Index::kWritten, 0); }, mcap},
        {"mcap, lz4", "d.mcap", Kind::kCdr, [](Path p, Bag b) { writeMcap(p, b, "lz4"); }, mcap},
        {"mcap, zstd", "d.mcap", Kind::kCdrBigEndian,
         [](Path p, Bag b) { writeMcap(p, b, "zstd"); }, mcap},
        {"mcap, no summary", "d.mcap", Kind::kCdr,
         [](Path p, Bag b) { writeMcap(p, b, "zstd", Index::kNever); }, mcap},
    };
}

/** Expects the points, rings, times and stamp that drive() gives its scan `i`. */
inline void expectScan(const Scan& scan, std::size_t i, std::size_t points = 20) {
    EXPECT_EQ(scan.index, i);
    EXPECT_NEAR(scan.stamp_s, kBegin_s + 0.1 * static_cast<double>(i), 1e-6);
    EXPECT_NEAR(mrpt::Clock::toDouble(scan.time), scan.stamp_s, 1e-6);
    ASSERT_EQ(scan.points->size(), points);
    ASSERT_EQ(scan.rings.size(), points);
    ASSERT_EQ(scan.times_s.size(), points);
    for (std::size_t k = 0; k < points; ++k) {
        float x = 0, y = 0, z = 0;
        scan.points->getPoint(k, x, y, z);
        ASSERT_EQ(x, static_cast<float>(10 + i));
        ASSERT_EQ(y, static_cast<float>(k));
        ASSERT_EQ(z, -1.5F);
        ASSERT_EQ(scan.rings[k], k % 16);
        ASSERT_NEAR(scan.times_s[k], 0.001F * static_cast<float>(k % 100), 1e-6);
    }
}

/** What came of reading a bag to its end. */
struct Outcome {
    std::size_t scans = 0;
    std::string fault;  //!< empty: none
    bool opened = false;
};

/** Reads all; expects an Error to be one line, and the end after it. */
template <typename Open>
Outcome readAll(const Open& open, const io::ScanSource& source) {
    Outcome outcome;
    std::unique_ptr<io::ScanReader> reader;
    try {
        reader = open(source);
        outcome.opened = true;
        while (const auto scan = reader->next()) {
            expectScan(*scan, outcome.scans, scan->points->size());
            ++outcome.scans;
        }
    } catch (const Error& e) {
        outcome.fault = e.what();
        EXPECT_EQ(outcome.fault.find('\n'), std::string::npos) << outcome.fault;
        EXPECT_NE(outcome.fault.find(source.path), std::string::npos) << outcome.fault;
    }
    if (reader) {
        EXPECT_FALSE(reader->next());
        EXPECT_FALSE(reader->skip());
    }
    return outcome;
}

template <typename Open>
std::string faultOf(const Open& open, const io::ScanSource& source) {
    return readAll(open, source).fault;
}

inline void expectHolds(const std::string& text, const std::vector<std::string>& words) {
    for (const std::string& word : words)
        EXPECT_NE(text.find(word), std::string::npos) << "'" << word << "' in: " << text;
}
}  // namespace delio::bag_test
