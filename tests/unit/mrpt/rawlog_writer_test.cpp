#include "delio/mrpt/rawlog_writer.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "delio/core/error.h"
#include "delio/recordings/rawlog_reader.h"
#include "test_data.h"
#include "toy_drive.h"

namespace {
using namespace delio;
using test::namesIn;
using Names = std::vector<std::string>;

const std::vector<float> kPoints = {1, 2, 3, 0.5F, -4, 5, -6, 0.25F};

std::string faultOf(const std::string& path, bool force = false) {
    try {
        const io::RawlogWriter writer(path, "lidar", false, force);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

TEST(RawlogWriter, AnAbortedDriveLeavesNothingBehindAndOldFilesUntouched) {
    const test::TemporaryFolder folder;
    for (const bool old : {false, true}) {
        const Names names = {"out.calib.txt", "out.meta.yaml", "out.rawlog", "out_Images",
                             "out_Images/000000.bin"};
        if (old) {
            std::filesystem::create_directory(folder / "out_Images");
            for (const auto& name : names)
                if (name != "out_Images") test::writeText(folder / name, "old " + name);
        }
        for (const bool embed : {false, true}) {
            io::RawlogWriter writer(folder / "out.rawlog", "lidar", embed, old);
            writer.add(0, 1000, kPoints);
            writer.addExtra(".ring", std::vector<std::uint16_t>{0});
        }
        EXPECT_EQ(namesIn(folder.path()), old ? names : Names{});
        for (const auto& name : namesIn(folder.path()))
            if (name != "out_Images") {
                EXPECT_EQ(test::readText(folder / name), "old " + name);
            }
    }
}

TEST(RawlogWriter, ReplacesOnlyWithForceAndThenEverything) {
    const test::TemporaryFolder folder;
    for (const std::string name : {"out.rawlog", "out_Images", "out.meta.yaml", "out.times.txt",
                                   "out.calib.txt", "out.poses.txt", "out.faults.tsv"}) {
        test::writeText(folder / name, "old");
        const std::string fault = faultOf(folder / "out.rawlog");
        EXPECT_NE(fault.find("--force"), std::string::npos) << name;
        EXPECT_NE(fault.find(name), std::string::npos) << fault;
        EXPECT_EQ(test::readText(folder / name), "old");
        std::filesystem::remove(folder / name);
    }
    const auto write = [&](std::size_t scans, const std::string& calib) {
        io::RawlogWriter writer(folder / "out.rawlog", "lidar", false, true);
        for (std::size_t i = 0; i < scans; ++i) writer.add(0.1, 1000, kPoints);
        EXPECT_EQ(writer.scans(), scans);
        writer.finish({}, "0\n", calib, "");
    };
    write(2, "Tr: 1\n");
    test::writeText(folder / "out.faults.tsv", "of the drive before");
    EXPECT_EQ(test::readText(folder / "out.calib.txt"), "Tr: 1\n");
    write(1, "");
    EXPECT_EQ(namesIn(folder.path()), (Names{"out.meta.yaml", "out.rawlog", "out.times.txt",
                                             "out_Images", "out_Images/000000.bin"}));
}

TEST(RawlogWriter, RefusesNamesThatCannotBe) {
    const test::TemporaryFolder folder;
    std::filesystem::create_directory(folder / "folder.rawlog");
    EXPECT_NE(faultOf(folder / "out.txt").find(".rawlog"), std::string::npos);
    EXPECT_NE(faultOf(folder / "folder.rawlog", true).find("folder"), std::string::npos);
    EXPECT_NE(faultOf(folder / "none/out.rawlog").find("out.rawlog"), std::string::npos);
    EXPECT_EQ(namesIn(folder.path()), Names{"folder.rawlog"});
}

/** Points bit by bit and times to MRPT's 100 ns, with an epoch that is no whole second. */
TEST(RawlogWriter, WhatWasWrittenIsRead) {
    const double epoch_s = 1317042145.951199;
    const std::vector<double> stamps_s = {0, 0.1034567, 0.9999999, 4541.2345678};
    for (const bool embed : {false, true}) {
        const test::TemporaryFolder folder;
        io::RawlogWriter writer(folder / "out.rawlog", "lidar", embed, false);
        for (const double stamp_s : stamps_s) writer.add(stamp_s, epoch_s, kPoints);
        io::DriveMeta meta;
        meta.epoch_s = epoch_s;
        writer.finish(meta, "", "", "");
        EXPECT_EQ(std::filesystem::exists(folder / "out_Images/000003.bin"), !embed);
        io::RawlogReader reader(folder / "out.rawlog");
        for (const double stamp_s : stamps_s) {
            const auto scan = reader.next();
            ASSERT_TRUE(scan);
            EXPECT_NEAR(scan->stamp_s, stamp_s, 5.1e-8);
            ASSERT_EQ(scan->points->size(), 2U);
            for (std::size_t i = 0; i < 2; ++i) {
                std::vector<float> fields;
                scan->points->getPointAllFieldsFast(i, fields);
                EXPECT_TRUE(std::equal(fields.begin(), fields.end(), &kPoints[4 * i]));
            }
        }
        EXPECT_FALSE(reader.next());
        EXPECT_EQ(reader.label(), "lidar");
    }
}
}  // namespace
