#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "command.h"
#include "delio/formats/drive_meta.h"
#include "test_data.h"
#include "toy_drive.h"

namespace delio::test {
namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/** A few points, different for every scan. */
inline Floats fewPoints(std::size_t scan, std::size_t count = 5) {
    Floats points;
    for (std::size_t i = 0; i < 4 * count; ++i)
        points.push_back(0.1F * static_cast<float>(i) - 3.3F * static_cast<float>(scan));
    return points;
}

inline std::vector<Floats> fewScans(std::size_t count) {
    std::vector<Floats> scans;
    for (std::size_t i = 0; i < count; ++i) scans.push_back(fewPoints(i));
    return scans;
}

class KittiTools : public testing::Test {
 protected:
    void SetUp() override {
        writeSequence(seq_, fewScans(5));
        fs::create_directory(folder_ / "out");
    }

    CommandResult toRawlog(const Words& more = {}) const {
        Words words = {"-i", seq_, "-o", rawlog_};
        words.insert(words.end(), more.begin(), more.end());
        return runTool("kitti2rawlog", words);
    }
    CommandResult toKitti(const fs::path& target, const Words& more = {}) const {
        Words words = {"-i", rawlog_, "-o", target};
        words.insert(words.end(), more.begin(), more.end());
        return runTool("rawlog2kitti", words);
    }
    /** A failed conversion leaves nothing behind. */
    void expectRefused(const CommandResult& run, int exitCode, const Words& words) const {
        expectFailure(run, exitCode, words);
        EXPECT_EQ(run.out, "");
        EXPECT_EQ(namesIn(folder_ / "out"), Words());
    }
    fs::path side(const std::string& extension) const {
        return io::sidecarPath(rawlog_, extension);
    }

    TemporaryFolder folder_;
    fs::path seq_ = folder_ / "seq";
    fs::path rawlog_ = folder_ / "out" / "d.rawlog";
};
}  // namespace delio::test
