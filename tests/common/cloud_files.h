#pragma once
#include <gtest/gtest.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "delio/core/error.h"
#include "formats/point_records.h"
#include "recordings/point_table.h"
#include "recordings/sources.h"
#include "test_data.h"

/** Files of a cloud each, to be read in tests. */
namespace delio::cloud_test {
namespace fs = std::filesystem;
using Xyzi = std::array<float, 4>;

/** Points that tell which scan they are of. */
inline std::vector<Xyzi> pointsOf(int scan, int count = 5) {
    std::vector<Xyzi> points;
    for (int i = 0; i < count; ++i)
        points.push_back({0.1F * static_cast<float>(i), static_cast<float>(scan), -1.75F,
                          0.25F * static_cast<float>(i % 4)});
    return points;
}

/** The bytes of values as they lie in memory. */
template <typename... Values>
std::string raw(const Values&... values) {
    std::string bytes;
    (bytes.append(reinterpret_cast<const char*>(&values), sizeof(values)), ...);
    return bytes;
}

inline std::string rawPoints(const std::vector<Xyzi>& points) {
    std::string bytes;
    for (const auto& p : points) bytes += raw(p);
    return bytes;
}

inline void writeBin(const fs::path& file, const std::vector<Xyzi>& points) {
    test::writeText(file, rawPoints(points));
}

/** The scan that PointTable makes of records. */
inline Scan scanOf(const io::CloudRecords& records) {
    return io::PointTable().scan(records.layout, records.bytes.data(), records.bytes.size(),
                                 records.count, records.rows, {});
}

inline std::vector<Xyzi> pointsOf(const Scan& scan) {
    const auto& map = dynamic_cast<const mrpt::maps::CPointsMapXYZI&>(*scan.points);
    std::vector<Xyzi> points;
    for (std::size_t i = 0; i < map.size(); ++i)
        points.push_back({map.getPointsBufferRef_x()[i], map.getPointsBufferRef_y()[i],
                          map.getPointsBufferRef_z()[i], map.getPointIntensity(i)});
    return points;
}

/** What `act` throws; empty: nothing. */
template <typename Act>
std::string errorOf(const Act& act) {
    try {
        act();
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

/** `error` is one line that holds all `words`. */
inline void expectError(const std::string& error, const std::vector<std::string>& words) {
    EXPECT_NE(error, "");
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    for (const auto& word : words) EXPECT_NE(error.find(word), std::string::npos) << error;
}
}  // namespace delio::cloud_test
