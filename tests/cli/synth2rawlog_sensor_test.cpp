// What synth2rawlog's options do to sensor, traffic and recording.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <sstream>

#include "command.h"
#include "delio/formats/drive_meta.h"
#include "delio/formats/trajectory.h"
#include "delio/recordings/rawlog_reader.h"
#include "poses.h"
#include "test_data.h"

namespace {
using namespace delio;
using test::runTool;
namespace fs = std::filesystem;

test::CommandResult synth(const fs::path& output, std::vector<std::string> more) {
    std::vector<std::string> words = {"-o", output.string(), "--scene", "urban"};
    words.insert(words.end(), more.begin(), more.end());
    return runTool("synth2rawlog", words);
}

template <typename Value>
std::vector<Value> valuesOf(const fs::path& file) {
    const std::string bytes = test::readText(file);
    std::vector<Value> values(bytes.size() / sizeof(Value));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(Value));
    return values;
}

std::string scanName(std::size_t scan) {
    const std::string number = std::to_string(scan);
    return std::string(6 - number.size(), '0') + number;
}

struct FaultRow {
    std::size_t driveScan;
    std::string scan, kind;
};

/** The rows of faults.tsv, below its header. */
std::vector<FaultRow> faultsOf(const fs::path& file) {
    std::istringstream lines(test::readText(file));
    std::vector<FaultRow> rows;
    bool header = false;
    for (std::string line; std::getline(lines, line);) {
        if (line[0] == '#') continue;
        if (!header) {
            EXPECT_EQ(line, "drive_scan\tscan\tkind");
            header = true;
            continue;
        }
        FaultRow row;
        std::istringstream(line) >> row.driveScan >> row.scan >> row.kind;
        rows.push_back(row);
    }
    EXPECT_TRUE(header);
    return rows;
}

TEST(Synth2rawlogSensor, AllOptionsTogetherGiveTheSameBytesForAnyNumberOfThreads) {
    const test::TemporaryFolder folder;
    for (const std::string threads : {"1", "2", "3"}) {
        fs::create_directory(folder / threads);
        const auto run = synth(folder / threads / "d.rawlog",
                               {"--scans", "6", "--threads", threads, "--movers", "12", "--distort",
                                "--labels", "--ring-bias", "0.02", "--drop-rate", "0.2",
                                "--repeat-rate", "0.2", "--empty-rate", "0.2", "--seed", "2"});
        ASSERT_EQ(run.exitCode, 0) << run.err;
    }
    std::size_t files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder / "1")) {
        if (!entry.is_regular_file()) continue;
        const auto name = fs::relative(entry.path(), folder / "1");
        for (const std::string threads : {"2", "3"})
            EXPECT_EQ(test::readText(entry.path()), test::readText(folder / threads / name))
                << name;
        ++files;
    }
    const auto written = io::readTimes(folder / "1" / "d.times.txt").size();
    EXPECT_EQ(files, 4 * written + 7);
}

TEST(Synth2rawlogSensor, SideFilesHaveAValueForEachPoint) {
    const test::TemporaryFolder folder;
    for (const std::string embed : {"", "--embed"}) {
        std::vector<std::string> words = {"--scans",  "2",        "--movers", "8",      "--distort",
                                          "--labels", "--sensor", "hdl32e",   "--force"};
        if (!embed.empty()) words.push_back(embed);
        const auto run = synth(folder / "d.rawlog", words);
        ASSERT_EQ(run.exitCode, 0) << run.err;
        io::RawlogReader reader(folder / "d.rawlog");
        for (std::size_t i = 0; i < 2; ++i) {
            const std::string name = "d_Images/" + scanName(i);
            const auto count = reader.next()->points->size();
            const auto times = valuesOf<float>(folder / (name + ".time"));
            const auto rings = valuesOf<std::uint16_t>(folder / (name + ".ring"));
            const auto labels = valuesOf<std::uint8_t>(folder / (name + ".label"));
            EXPECT_GT(count, 20000U);
            ASSERT_EQ(times.size(), count);
            ASSERT_EQ(rings.size(), count);
            ASSERT_EQ(labels.size(), count);
            EXPECT_LE(*std::max_element(times.begin(), times.end()), 0.05F);
            EXPECT_LT(*std::min_element(times.begin(), times.end()), -0.04F);
            EXPECT_TRUE(std::is_sorted(rings.begin(), rings.end()));
            EXPECT_EQ(rings.back(), 31);
            EXPECT_GT(std::count(labels.begin(), labels.end(), 1), 300);
            EXPECT_LE(*std::max_element(labels.begin(), labels.end()), 1);
        }
        EXPECT_FALSE(io::readDriveMeta(folder / "d.rawlog")->motionCompensated);
    }
}

TEST(Synth2rawlogSensor, WhatIsNotAskedForIsNotWritten) {
    const test::TemporaryFolder folder;
    ASSERT_EQ(synth(folder / "d.rawlog", {"--scans", "1"}).exitCode, 0);
    EXPECT_TRUE(fs::exists(folder / "d_Images/000000.ring"));
    EXPECT_FALSE(fs::exists(folder / "d_Images/000000.time"));
    EXPECT_FALSE(fs::exists(folder / "d_Images/000000.label"));
    EXPECT_TRUE(faultsOf(folder / "d.faults.tsv").empty());
    const auto meta = io::readDriveMeta(folder / "d.rawlog");
    EXPECT_TRUE(meta->motionCompensated);
    EXPECT_EQ(meta->generator.rfind("synth2rawlog 2 ", 0), 0U) << meta->generator;
}

TEST(Synth2rawlogSensor, EachSensorIsNamedAndHasItsRings) {
    const test::TemporaryFolder folder;
    struct Expected {
        const char *option, *name;
        std::uint16_t last;
        std::size_t most;
    };
    const Expected all[] = {{"hdl64e", "HDL-64E", 63, 133312},
                            {"hdl32e", "HDL-32E", 31, 69440},
                            {"vlp16", "VLP-16", 15, 28928},
                            {"os1-64", "OS1-64", 63, 65536}};
    for (const auto& sensor : all) {
        const auto run =
            synth(folder / "d.rawlog", {"--scans", "1", "--sensor", sensor.option, "--force"});
        ASSERT_EQ(run.exitCode, 0) << run.err;
        EXPECT_EQ(io::readDriveMeta(folder / "d.rawlog")->sensorModel, sensor.name);
        const auto rings = valuesOf<std::uint16_t>(folder / "d_Images/000000.ring");
        EXPECT_EQ(rings.back(), sensor.last);
        EXPECT_GT(rings.size(), sensor.most / 2);
        EXPECT_LT(rings.size(), sensor.most);
    }
}

TEST(Synth2rawlogSensor, FaultsAreInTheRawlogAsListed) {
    const test::TemporaryFolder folder;
    const std::vector<std::string> common = {"--scans", "30", "--sensor", "vlp16", "--movers", "4"};
    ASSERT_EQ(synth(folder / "good.rawlog", common).exitCode, 0);
    auto words = common;
    for (const char* word : {"--drop-rate", "0.2", "--repeat-rate", "0.2", "--empty-rate", "0.2"})
        words.emplace_back(word);
    ASSERT_EQ(synth(folder / "bad.rawlog", words).exitCode, 0);

    const auto goodPoses = io::readTrajectory(folder / "good.poses.txt").poses;
    const auto poses = io::readTrajectory(folder / "bad.poses.txt").poses;
    const auto times = io::readTimes(folder / "bad.times.txt");
    const auto faults = faultsOf(folder / "bad.faults.tsv");
    ASSERT_EQ(times.size(), poses.size());
    std::map<std::string, int> kinds;
    io::RawlogReader reader(folder / "bad.rawlog");
    std::size_t written = 0;
    std::string last;
    auto fault = faults.begin();
    for (std::size_t scan = 0; scan < 30; ++scan) {
        std::string kind = "none";
        if (fault != faults.end() && fault->driveScan == scan) {
            kind = fault->kind;
            EXPECT_EQ(fault->scan, kind == "dropped" ? "-" : std::to_string(written));
            ++fault;
        }
        ++kinds[kind];
        if (kind == "dropped") continue;
        const auto observation = reader.next();
        ASSERT_TRUE(observation);
        EXPECT_NEAR(observation->stamp_s, 0.1 * static_cast<double>(scan), 1e-6);
        EXPECT_NEAR(times[written], 0.1 * static_cast<double>(scan), 1e-9);
        EXPECT_LT(test::metresBetween(poses[written], goodPoses[scan]), 1e-12);
        const auto bytes = test::readText(folder / ("bad_Images/" + scanName(written) + ".bin"));
        const auto good = test::readText(folder / ("good_Images/" + scanName(scan) + ".bin"));
        if (kind == "none") {
            EXPECT_EQ(bytes, good);
        } else if (kind == "empty") {
            EXPECT_TRUE(bytes.empty());
        } else {
            EXPECT_EQ(bytes, last);
        }
        last = bytes;
        ++written;
    }
    EXPECT_EQ(written, times.size());
    EXPECT_FALSE(reader.next());
    EXPECT_EQ(fault, faults.end());
    for (const auto* kind : {"none", "dropped", "repeated", "empty"}) EXPECT_GT(kinds[kind], 1);
}

TEST(Synth2rawlogSensor, SaysSoWhereTheRoadIsFull) {
    const test::TemporaryFolder folder;
    const auto run =
        synth(folder / "d.rawlog", {"--scans", "1", "--sensor", "vlp16", "--movers", "5000"});
    EXPECT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NE(run.err.find("warning: the road only has room for"), std::string::npos) << run.err;
}

TEST(Synth2rawlogSensor, GoesToKittiAndBack) {
    const test::TemporaryFolder folder;
    ASSERT_EQ(synth(folder / "d.rawlog", {"--scans", "4", "--movers", "6", "--distort", "--labels",
                                          "--sensor", "vlp16", "--empty-rate", "0.5"})
                  .exitCode,
              0);
    const auto there = runTool(
        "rawlog2kitti", {"-i", (folder / "d.rawlog").string(), "-o", (folder / "k").string()});
    ASSERT_EQ(there.exitCode, 0) << there.err;
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_EQ(test::readText(folder / ("k/velodyne/" + scanName(i) + ".bin")),
                  test::readText(folder / ("d_Images/" + scanName(i) + ".bin")));
    for (const std::string name : {"poses.txt", "times.txt", "calib.txt"})
        EXPECT_EQ(test::readText(folder / ("k/" + name)), test::readText(folder / ("d." + name)));
}
}  // namespace
