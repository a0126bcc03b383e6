#pragma once
#include <gtest/gtest.h>
#include <mrpt/containers/yaml.h>

#include <filesystem>
#include <string>
#include <vector>

#include "command.h"
#include "delio/mrpt/rawlog_writer.h"
#include "scan_columns.h"
#include "test_data.h"
#include "toy_drive.h"

namespace delio::test {
using Words = std::vector<std::string>;

inline Words operator+(Words a, const Words& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

/** Scans of a toy drive as a rawlog, 1 m and 0.1 s apart, and delio-slam run on them. */
class DelioSlam : public testing::Test {
 protected:
    static constexpr std::size_t kScans = 5;
    static constexpr const char* kTr = "Tr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n";

    /** Scans as a rawlog with all that belongs beside it. */
    void writeDrive(const std::filesystem::path& rawlog, const std::vector<Floats>& scans,
                    bool embed = false, std::vector<double> times = {}) const {
        io::RawlogWriter writer(rawlog, "velodyne", embed, true);
        std::string poses, timesText;
        for (std::size_t i = 0; i < scans.size(); ++i) {
            const auto n = static_cast<double>(i);
            if (times.size() <= i) times.push_back(0.1 * n);
            writer.add(times[i], io::kDriveEpoch_s, scans[i]);
            timesText += std::to_string(times[i]) + "\n";
            poses += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(n) + "\n";  // 1 m a scan
        }
        io::DriveMeta meta;
        meta.source = "synthetic";
        meta.epoch_s = io::kDriveEpoch_s;
        writer.finish(meta, timesText, kTr, poses);
    }
    void writeDrive(std::size_t scans = kScans, bool embed = false) const {
        writeDrive(rawlog_, toyScans(scans), embed);
    }

    /** Without a map a run is short. */
    CommandResult slam(const Words& more = {}) const { return slamOf(rawlog_, more); }
    CommandResult slamOf(const std::filesystem::path& input, const Words& more = {}) const {
        return runTool("delio-slam", Words{"-i", input, "-o", out_, "--no-map"} + more);
    }
    /** Nothing came out at all. */
    void expectRefused(const CommandResult& run, int exitCode, const Words& words) const {
        expectFailure(run, exitCode, words);
        EXPECT_EQ(run.out, "");
        EXPECT_FALSE(std::filesystem::exists(out_));
    }
    /** Ended early: what was done is there and consistent, and said to be incomplete. */
    void expectPart(std::size_t scans) const {
        EXPECT_FALSE(summary()["complete"].as<bool>());
        EXPECT_EQ(summary()["scans"].as<int>(), static_cast<int>(scans));
        EXPECT_EQ(rows("trajectory_kitti.txt"), scans);
        EXPECT_EQ(rows("trajectory_tum.txt"), scans);
        EXPECT_EQ(rows("scans.csv"), scans + 1);
        expectNothingPartial();
    }
    void expectNothingPartial() const {
        for (const auto& name : namesIn(out_))
            EXPECT_EQ(name.find("partial"), std::string::npos) << name;
    }
    mrpt::containers::yaml summary() const {
        return mrpt::containers::yaml::FromFile((out_ / "summary.yaml").string());
    }
    std::size_t rows(const std::string& name) const {
        return linesOf(readText(out_ / name)).size();
    }

    TemporaryFolder folder_;
    std::filesystem::path rawlog_ = folder_ / "d.rawlog";
    std::filesystem::path out_ = folder_ / "out";
};
}  // namespace delio::test
