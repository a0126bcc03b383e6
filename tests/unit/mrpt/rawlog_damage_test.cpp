// Rawlogs that are cut off or damaged.
#include <gtest/gtest.h>
#include <mrpt/obs/CObservationRotatingScan.h>
#include <mrpt/obs/CObservationVelodyneScan.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <sys/resource.h>

#include <random>

#include "memory_limit.h"
#include "rawlog_files.h"

namespace {
using namespace delio;
using namespace delio::rawlog_test;

TEST(RawlogReader, WhatCameBeforeACutComesOutThenOneError) {
    const test::TemporaryFolder folder;
    const std::string whole = folder / "whole.rawlog", cut = folder / "cut.rawlog";
    for (const bool compressed : {false, true}) {
        std::vector<mrpt::serialization::CSerializable::Ptr> objects;
        std::vector<std::size_t> ends;  // of the objects, where the file is not compressed
        for (int scan = 0; scan < 4; ++scan) {
            objects.push_back(cloudObservation(scan));
            if (compressed) continue;
            writeRawlog(whole, objects);
            ends.push_back(test::readText(whole).size());
        }
        if (compressed) writeRawlog<mrpt::io::CFileGZOutputStream>(whole, objects);
        const std::string bytes = test::readText(whole);
        std::size_t most = 0;
        for (std::size_t size = 1; size < bytes.size(); size += 1 + size / 20) {
            test::writeText(cut, bytes.substr(0, size));
            io::RawlogReader reader(cut);
            std::size_t scans = 0;
            const std::string fault = faultOf(reader, scans);
            EXPECT_FALSE(fault.empty()) << size << " bytes";
            EXPECT_EQ(fault.find('\n'), std::string::npos);
            EXPECT_GE(scans, most) << "more of the file, fewer scans";
            most = scans;
            if (compressed) continue;
            std::size_t before = 0;
            while (before < ends.size() && ends[before] <= size) ++before;
            EXPECT_EQ(scans, before) << size << " bytes";
        }
        // At the end of an object nothing is cut.
        if (compressed) continue;
        test::writeText(cut, bytes.substr(0, ends[1]));
        io::RawlogReader reader(cut);
        std::size_t scans = 0;
        EXPECT_EQ(faultOf(reader, scans), "");
        EXPECT_EQ(scans, 2U);
    }
}

/** All that can be unpacked is there, and yet the end is not what gzip wrote. */
TEST(RawlogReader, AChecksumThatIsWrongOrCutOffIsNoEndOfTheRawlog) {
    const test::TemporaryFolder folder;
    const std::string path = folder / "a.rawlog";
    writeRawlog<mrpt::io::CFileGZOutputStream>(path, {cloudObservation(0), cloudObservation(1)});
    const std::string whole = test::readText(path);
    for (std::size_t i = 1; i <= 8; ++i) {
        std::size_t scans = 0;
        test::writeText(path, whole.substr(0, whole.size() - i));
        io::RawlogReader cut(path);
        EXPECT_NE(faultOf(cut, scans).find("after scan 1"), std::string::npos) << i;
        EXPECT_EQ(scans, 2U);

        // zlib keeps back the last of what it unpacked when the checksum is wrong.
        std::string damaged = whole;
        damaged[whole.size() - i] = static_cast<char>(damaged[whole.size() - i] ^ 1);
        test::writeText(path, damaged);
        io::RawlogReader reader(path);
        EXPECT_NE(faultOf(reader, scans), "") << i;
    }
}

/** The count of a cloud's points is looked at before there is room made for them. */
TEST(RawlogReader, ACloudThatClaimsTooManyPoints) {
    const test::TemporaryFolder folder;
    rusage before{}, after{};
    for (const bool compressed : {false, true}) {
        const std::string path = folder / "a.rawlog";
        writeRawlog(path, {cloudObservation(0), cloudObservation(1)});
        std::string bytes = test::readText(path);
        const std::string name = "mrpt::maps::CPointsMapXYZI";
        const auto count = bytes.rfind(name) + name.size() + 1;
        ASSERT_EQ(bytes[count], 50);
        bytes[count + 3] = 0x08;  // 2 GB
        test::writeText(path, bytes);
        if (compressed) mrpt::io::CFileGZOutputStream(path).Write(bytes.data(), bytes.size());
        io::RawlogReader reader(path);
        std::size_t scans = 0;
        getrusage(RUSAGE_SELF, &before);
        EXPECT_NE(faultOf(reader, scans).find("after scan 0"), std::string::npos);
        getrusage(RUSAGE_SELF, &after);
        EXPECT_EQ(scans, 1U);
        EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 200'000) << "kB";
    }
}

/** A bit of a rawlog is turned: whatever it hits, there is at most one Error, no crash and no
 *  object larger than memory is. */
TEST(RawlogReader, DamagedBytes) {
    const test::TemporaryFolder folder;
    const auto image = mrpt::obs::CObservationRotatingScan::Create();
    image->sensorLabel = "lidar";
    image->rowCount = 16;
    image->rangeResolution = 0.01;
    image->rangeImage.setZero(16, 2);
    const auto frame = mrpt::obs::CSensoryFrame::Create();
    frame->insert(cloudObservation(1));
    std::vector<mrpt::serialization::CSerializable::Ptr> objects = {cloudObservation(0), image,
                                                                    frame, cloudObservation(2)};
    const test::MemoryLimit limit(256);
    if (limit.works()) {  // an object of 1206 bytes for each that its count claims
        const auto packets = mrpt::obs::CObservationVelodyneScan::Create();
        packets->sensorLabel = "lidar";
        packets->calibration = mrpt::obs::VelodyneCalibration::LoadDefaultCalibration("VLP16");
        packets->scan_packets.resize(1);
        objects.push_back(packets);
    }
    writeRawlog(folder / "plain.rawlog", objects);
    writeRawlog<mrpt::io::CFileGZOutputStream>(folder / "gz.rawlog", objects);
    std::mt19937 random(5);
    for (const std::string name : {"plain.rawlog", "gz.rawlog"}) {
        // What is unpacked from damaged data may ask for any size.
        if (name == "gz.rawlog" && !limit.works()) continue;
        const std::string whole = test::readText(folder / name);
        std::size_t faults = 0;
        for (int trial = 0; trial < 600; ++trial) {
            std::string bytes = whole;
            // Behind gzip's ten bytes of header, which may be anything.
            const std::size_t at =
                name == "gz.rawlog" ? 10 + random() % (bytes.size() - 10) : random() % bytes.size();
            bytes[at] = static_cast<char>(bytes[at] ^ (limit.works() ? 1 << random() % 8 : 1));
            test::writeText(folder / "damaged.rawlog", bytes);
            io::RawlogReader reader(folder / "damaged.rawlog");
            std::size_t scans = 0;
            const std::string fault = faultOf(reader, scans);
            faults += !fault.empty();
            EXPECT_LE(scans, objects.size());
            EXPECT_EQ(fault.find('\n'), std::string::npos) << fault;
            // A match of zeros may lie elsewhere in what was unpacked: that is no damage.
            if (name == "gz.rawlog" && fault.empty()) {
                EXPECT_EQ(scans, objects.size());
            }
        }
        EXPECT_GT(faults, name == "gz.rawlog" ? 500U : 20U) << name;
    }
}
}  // namespace
