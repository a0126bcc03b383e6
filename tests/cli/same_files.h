#pragma once
#include <gtest/gtest.h>
#include <mrpt/io/CFileGZInputStream.h>

#include <filesystem>
#include <string>

#include "scan_columns.h"
#include "test_data.h"

namespace delio::test {
/** What a compressed file holds: its head has the time at which it was made. */
inline std::string payload(const std::filesystem::path& file) {
    mrpt::io::CFileGZInputStream in(file.string());
    std::string bytes;
    char block[65536];
    while (const auto count = in.Read(block, sizeof(block))) bytes.append(block, count);
    return bytes;
}

/** Two results with a map are the same, but for what was measured of time and memory. */
inline void expectSameResults(const std::filesystem::path& one,
                              const std::filesystem::path& other) {
    for (const char* name :
         {"trajectory_kitti.txt", "trajectory_odometry_kitti.txt", "trajectory_kitti_cam0.txt",
          "trajectory_tum.txt", "trajectory_mrpt.txt", "posegraph.g2o", "posegraph.graph",
          "loops.csv", "config.ini", "map.ply", "map.delio"}) {
        // The paper's profiles close no loops: they leave neither loops.csv nor map.delio.
        if (!std::filesystem::exists(one / name) && !std::filesystem::exists(one / "loops.csv")) {
            EXPECT_FALSE(std::filesystem::exists(other / name)) << name;
            continue;
        }
        // Not EXPECT_EQ, which would print maps.
        EXPECT_TRUE(readText(one / name) == readText(other / name)) << other << " " << name;
    }
    for (const char* name : {"map.simplemap", "map.3Dscene"}) {
        EXPECT_GT(payload(one / name).size(), 100000U) << name;
        EXPECT_TRUE(payload(one / name) == payload(other / name)) << other << " " << name;
    }
    auto a = csvColumns(one / "scans.csv"), b = csvColumns(other / "scans.csv");
    EXPECT_EQ(a.size(), b.size());
    for (const auto& [column, cells] : a) {
        const bool isTime = column.size() > 3 && column.substr(column.size() - 3) == "_ms";
        if (!isTime) {
            EXPECT_EQ(cells, b[column]) << other << " " << column;
        }
    }
}

}  // namespace delio::test
