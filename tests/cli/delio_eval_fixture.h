#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "command.h"
#include "delio/formats/trajectory.h"
#include "poses.h"
#include "test_data.h"

namespace delio::test {
inline const std::string kTr = "Tr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n";

/** A straight drive, z forward, as cam0 has it; 0.1 s between poses. */
inline io::Trajectory cameraDrive(double step_m, std::size_t count) {
    io::Trajectory drive;
    for (std::size_t i = 0; i < count; ++i) {
        const auto n = static_cast<double>(i);
        drive.poses.push_back(poseAt(0, 0, step_m * n));
        drive.stamps_s.push_back(0.1 * n);
    }
    return drive;
}

/** The same, x forward, as a LiDAR has it. */
inline io::Trajectory lidarDrive(double step_m, std::size_t count) {
    io::Trajectory drive = cameraDrive(step_m, count);
    for (auto& pose : drive.poses) pose = poseAt(pose.translation().z(), 0, 0);
    return drive;
}

/** Rows of a tsv as cells. */
inline std::vector<std::vector<std::string>> tsv(const std::string& text) {
    std::vector<std::vector<std::string>> rows;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        rows.emplace_back();
        std::istringstream cells(line);
        for (std::string cell; std::getline(cells, cell, '\t');) rows.back().push_back(cell);
    }
    return rows;
}

class DelioEval : public testing::Test {
 protected:
    /** A drive of 250 m, an estimate that is 1 % too long, and the same in the LiDAR frame. */
    void SetUp() override {
        io::writeKitti(cameraDrive(0.5, 501), folder_ / "ref.txt");
        io::writeKitti(cameraDrive(0.505, 501), folder_ / "est.txt");
        io::writeKitti(lidarDrive(0.505, 501), folder_ / "lidar.txt");
        writeText(folder_ / "calib.txt", kTr);
    }

    std::string in(const std::string& name) const { return folder_ / name; }

    CommandResult eval(const std::vector<std::string>& arguments) const {
        return runTool("delio-eval", arguments);
    }
    CommandResult tsvOf(const std::string& ref, const std::string& est) const {
        return eval({"--ref", in(ref), "--est", in(est), "--format", "tsv"});
    }

    /** A failed run: its exit code, nothing on stdout, and one line that holds `words`. */
    void expectFailure(const CommandResult& result, int exitCode, const std::string& words) {
        EXPECT_EQ(result.exitCode, exitCode);
        EXPECT_EQ(result.out, "");
        EXPECT_TRUE(isOneLine(result.err)) << result.err;
        EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
    }

    TemporaryFolder folder_;
};
}  // namespace delio::test
