#include "delio/io/scan_source.h"

#include <gtest/gtest.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CObservationRotatingScan.h>
#include <mrpt/obs/CObservationVelodyneScan.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>
#include <sys/resource.h>

#include <fstream>
#include <random>

#include "delio/error.h"
#include "memory_limit.h"
#include "test_data.h"

namespace {
using namespace delio;
using mrpt::obs::CObservationPointCloud;
using mrpt::poses::CPose3D;

const CPose3D kOnTheRoof(1, 0.5, 1.8, 0.3, 0.02, -0.01);

/** A cloud of `points` points that tell which scan they are of. */
CObservationPointCloud::Ptr cloudObservation(int scan, const std::string& label = "lidar",
                                             std::size_t points = 50) {
    auto cloud = mrpt::maps::CPointsMapXYZI::Create();
    for (std::size_t i = 0; i < points; ++i)
        cloud->insertPoint(static_cast<float>(scan), static_cast<float>(i), -1.5F);
    auto observation = CObservationPointCloud::Create();
    observation->pointcloud = cloud;
    observation->sensorLabel = label;
    observation->sensorPose = kOnTheRoof;
    observation->timestamp = mrpt::Clock::fromDouble(1000 + 0.1 * scan);
    return observation;
}

template <typename Stream = mrpt::io::CFileOutputStream>
void writeRawlog(const std::string& path,
                 const std::vector<mrpt::serialization::CSerializable::Ptr>& objects) {
    Stream out(path);
    auto archive = mrpt::serialization::archiveFrom(out);
    for (const auto& object : objects) archive << *object;
}

std::string faultOf(io::ScanSource& source, std::size_t& scans) {
    scans = 0;
    try {
        while (source.next()) ++scans;
    } catch (const Error& e) {
        EXPECT_FALSE(source.next()) << "a source is at its end after an error";
        return e.what();
    }
    return "";
}

TEST(ScanSource, BareFramedAndActionFramedScansComeInOrder) {
    const test::TemporaryFolder folder;
    auto frame = mrpt::obs::CSensoryFrame::Create();
    frame->insert(cloudObservation(1));
    frame->insert(cloudObservation(7, "other"));
    writeRawlog(folder / "a.rawlog",
                {cloudObservation(0), frame, mrpt::obs::CActionCollection::Create(),
                 mrpt::obs::CObservationIMU::Create(), cloudObservation(2)});
    io::ScanSource source(folder / "a.rawlog", "", "", 1000);
    for (std::size_t i = 0; i < 3; ++i) {
        const auto scan = source.next();
        ASSERT_TRUE(scan);
        EXPECT_EQ(scan->index, i);
        EXPECT_DOUBLE_EQ(scan->stamp_s, 0.1 * static_cast<double>(i));
        EXPECT_EQ(scan->points->getPointsBufferRef_x()[0], static_cast<float>(i));
        EXPECT_EQ(scan->sensorPose, kOnTheRoof);
    }
    EXPECT_FALSE(source.next());
    EXPECT_FALSE(source.next());
    EXPECT_EQ(source.label(), "lidar");
    EXPECT_EQ(source.otherLabels(), std::set<std::string>{"other"});
    EXPECT_DOUBLE_EQ(source.fraction().value(), 1);

    io::ScanSource other(folder / "a.rawlog", "other");
    ASSERT_TRUE(other.skip());
    EXPECT_FALSE(other.skip());
    io::ScanSource none(folder / "a.rawlog", "nothing");
    EXPECT_FALSE(none.next());
}

TEST(ScanSource, DepthCamerasAndCloudsWithoutPoints) {
    const test::TemporaryFolder folder;
    auto depth = mrpt::obs::CObservation3DRangeScan::Create();
    depth->sensorLabel = "lidar";
    depth->hasPoints3D = true;
    depth->resizePoints3DVectors(2);
    depth->points3D_x = {4, 5};
    depth->points3D_y = {1, 2};
    depth->points3D_z = {0, 1};
    auto nothing = CObservationPointCloud::Create();
    nothing->sensorLabel = "lidar";
    writeRawlog(folder / "a.rawlog", {depth, nothing});
    io::ScanSource source(folder / "a.rawlog");
    const auto scan = source.next();
    ASSERT_TRUE(scan);
    ASSERT_EQ(scan->points->size(), 2U);
    EXPECT_EQ(scan->points->getPointsBufferRef_x()[1], 5);
    EXPECT_EQ(source.next()->points->size(), 0U);
}

TEST(ScanSource, ExternalCloudsAndWhereTheyAreLookedFor) {
    const test::TemporaryFolder folder;
    const float xyzi[8] = {1, 2, 3, 0.5F, 4, 5, 6, 0.25F};
    const auto writeBin = [&](const std::string& path, std::size_t bytes) {
        std::filesystem::create_directories(std::filesystem::path(path).parent_path());
        std::ofstream(path, std::ios::binary)
            .write(reinterpret_cast<const char*>(xyzi), static_cast<std::streamsize>(bytes));
    };
    const auto external = [](const std::string& file) {
        auto observation = CObservationPointCloud::Create();
        observation->sensorLabel = "lidar";
        observation->setAsExternalStorage(
            file, CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
        return observation;
    };
    writeRawlog(folder / "a.rawlog", {external("0.bin"), external("1.bin")});

    std::size_t scans = 0;
    io::ScanSource missing(folder / "a.rawlog");
    const std::string fault = faultOf(missing, scans);
    EXPECT_NE(fault.find("a_Images"), std::string::npos) << fault;
    EXPECT_NE(fault.find("/Images"), std::string::npos) << fault;

    for (const std::string where : {"a_Images", "Images", "elsewhere"}) {
        writeBin(folder / (where + "/0.bin"), 32);
        writeBin(folder / (where + "/1.bin"), 0);
        io::ScanSource source(
            folder / "a.rawlog", "",
            where == "elsewhere" ? (folder / "elsewhere").string() : std::string());
        const auto scan = source.next();
        ASSERT_TRUE(scan);
        ASSERT_EQ(scan->points->size(), 2U);
        EXPECT_EQ(scan->points->getPointsBufferRef_z()[1], 6);
        EXPECT_EQ(source.next()->points->size(), 0U);
        if (where == "elsewhere") break;
        std::filesystem::remove_all(folder / where);
    }
    writeBin(folder / "a_Images/0.bin", 30);
    io::ScanSource cut(folder / "a.rawlog");
    EXPECT_NE(faultOf(cut, scans).find("multiple of 16"), std::string::npos);
}

template <typename Value>
void writeValues(const std::filesystem::path& file, const std::vector<Value>& values) {
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(values.data()),
               static_cast<std::streamsize>(values.size() * sizeof(Value)));
}

TEST(ScanSource, RingsAndTimesOfPointsLieBesideTheExternalFiles) {
    const test::TemporaryFolder folder;
    std::filesystem::create_directory(folder / "a_Images");
    auto external = cloudObservation(0);
    writeValues<float>(folder / "a_Images/first.bin", {1, 2, 3, 0, 4, 5, 6, 0});
    external->setAsExternalStorage("first.bin",
                                   CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
    writeValues<std::uint16_t>(folder / "a_Images/first.ring", {7, 300});
    writeValues<float>(folder / "a_Images/first.time", {-0.05F, 0.03F});
    // An embedded scan has no file of its own: its extras are named by its number.
    writeValues<float>(folder / "a_Images/000001.time", std::vector<float>(50, 0.01F));
    writeRawlog(folder / "a.rawlog", {external, cloudObservation(1), cloudObservation(2)});
    io::ScanSource source(folder / "a.rawlog");
    const auto first = source.next(), second = source.next(), third = source.next();
    ASSERT_TRUE(third);
    EXPECT_EQ(first->rings, (std::vector<std::uint16_t>{7, 300}));
    EXPECT_EQ(first->times_s, (std::vector<float>{-0.05F, 0.03F}));
    EXPECT_EQ(second->times_s, std::vector<float>(50, 0.01F));
    EXPECT_TRUE(second->rings.empty());
    EXPECT_TRUE(third->times_s.empty());
}

TEST(ScanSource, ExtrasThatDoNotFitTheirScanAreNamed) {
    const test::TemporaryFolder folder;
    std::filesystem::create_directory(folder / "a_Images");
    writeValues<float>(folder / "a_Images/000001.time", {0, 0, 0});
    writeRawlog(folder / "a.rawlog", {cloudObservation(0), cloudObservation(1)});
    io::ScanSource source(folder / "a.rawlog");
    std::size_t scans = 0;
    const auto fault = faultOf(source, scans);
    EXPECT_EQ(scans, 1U);
    EXPECT_NE(fault.find("000001.time"), std::string::npos) << fault;
    EXPECT_NE(fault.find("12 bytes"), std::string::npos) << fault;
    EXPECT_NE(fault.find("50 points"), std::string::npos) << fault;
}

TEST(ScanSource, TimesThatCannotBeAreNamed) {
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), 1e9F, -2.0F}) {
        const test::TemporaryFolder folder;
        std::filesystem::create_directory(folder / "a_Images");
        std::vector<float> times_s(50, 0.01F);
        times_s[20] = bad;
        writeValues(folder / "a_Images/000001.time", times_s);
        writeRawlog(folder / "a.rawlog", {cloudObservation(0), cloudObservation(1)});
        io::ScanSource source(folder / "a.rawlog");
        std::size_t scans = 0;
        const auto fault = faultOf(source, scans);
        EXPECT_EQ(scans, 1U) << bad;
        EXPECT_NE(fault.find("000001.time"), std::string::npos) << fault;
    }
}

TEST(ScanSource, WhatCameBeforeACutComesOutThenOneError) {
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
            io::ScanSource source(cut);
            std::size_t scans = 0;
            const std::string fault = faultOf(source, scans);
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
        io::ScanSource source(cut);
        std::size_t scans = 0;
        EXPECT_EQ(faultOf(source, scans), "");
        EXPECT_EQ(scans, 2U);
    }
}

TEST(ScanSource, LabelsAndFractionOfPlainAndCompressedRawlogs) {
    const test::TemporaryFolder folder;
    std::vector<mrpt::serialization::CSerializable::Ptr> objects;
    objects.reserve(6);
    for (int scan = 0; scan < 6; ++scan)
        objects.push_back(cloudObservation(scan, scan % 3 == 1 ? "second" : "first"));
    writeRawlog(folder / "plain.rawlog", objects);
    writeRawlog<mrpt::io::CFileGZOutputStream>(folder / "gz.rawlog", objects);
    for (const std::string name : {"plain.rawlog", "gz.rawlog"}) {
        io::ScanSource source(folder / name, "second", "", 1000);
        EXPECT_EQ(source.fraction(), name == "gz.rawlog" ? std::nullopt : std::optional(0.0));
        for (const int of : {1, 4}) {
            const auto scan = source.next();
            ASSERT_TRUE(scan);
            EXPECT_EQ(scan->points->getPointsBufferRef_x()[0], static_cast<float>(of));
            EXPECT_NEAR(scan->stamp_s, 0.1 * of, 5.1e-8);
            if (name == "gz.rawlog")
                EXPECT_FALSE(source.fraction());
            else
                EXPECT_NEAR(source.fraction().value(), (of + 1) / 6.0, 0.01);
        }
        EXPECT_FALSE(source.next());
        EXPECT_EQ(source.otherLabels(), std::set<std::string>{"first"});
    }
}

/** To MRPT's tick of 100 ns, however large the epoch's own digits are. */
TEST(ScanSource, TimesAreCountedFromAnEpochThatIsNoWholeSecond) {
    const test::TemporaryFolder folder;
    std::vector<mrpt::serialization::CSerializable::Ptr> objects;
    for (int scan = 0; scan < 20; ++scan) {
        const auto observation = cloudObservation(scan, "lidar", 1);
        // 951199 us after the second is tick 9511990.
        observation->timestamp =
            mrpt::Clock::fromDouble(1317042145) + mrpt::Clock::duration(9511990 + 1033217 * scan);
        objects.push_back(observation);
    }
    writeRawlog(folder / "a.rawlog", objects);
    io::ScanSource source(folder / "a.rawlog", "", "", 1317042145.951199);
    for (int scan = 0; scan < 20; ++scan)
        EXPECT_NEAR(source.next()->stamp_s, 1033217e-7 * scan, 2.5e-7 / 2);
}

TEST(ScanSource, ExternalCloudsThatMrptSerialised) {
    const test::TemporaryFolder folder;
    const auto observation = CObservationPointCloud::Create();
    observation->sensorLabel = "lidar";
    observation->setAsExternalStorage(
        "0.gz", CObservationPointCloud::ExternalStorageFormat::MRPT_Serialization);
    writeRawlog(folder / "a.rawlog", {observation});
    std::filesystem::create_directory(folder / "a_Images");
    const std::string file = folder / "a_Images/0.gz";
    writeRawlog<mrpt::io::CFileGZOutputStream>(file, {cloudObservation(3)->pointcloud});
    const auto scan = io::ScanSource(folder / "a.rawlog").next();
    ASSERT_TRUE(scan);
    ASSERT_EQ(scan->points->size(), 50U);
    EXPECT_EQ(scan->points->getPointsBufferRef_y()[49], 49);

    const std::string whole = test::readText(file);
    for (std::size_t i = 10; i < whole.size(); i += 7) {
        std::string damaged = whole;
        damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
        for (const auto& bytes : {damaged, whole.substr(0, i)}) {
            test::writeText(file, bytes);
            io::ScanSource source(folder / "a.rawlog");
            std::size_t scans = 0;
            EXPECT_NE(faultOf(source, scans).find("0.gz"), std::string::npos) << "byte " << i;
        }
    }
}

/** KITTI's floats, gzipped as CPointsMap::saveToKittiVelodyneFile() does. */
TEST(ScanSource, CompressedFloatsAreCountedAsTheyUnpack) {
    const test::TemporaryFolder folder;
    const auto observation = CObservationPointCloud::Create();
    observation->setAsExternalStorage("0.bin",
                                      CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
    writeRawlog(folder / "a.rawlog", {observation});
    std::filesystem::create_directory(folder / "a_Images");
    const std::vector<float> xyzi(8, 1.0F);
    for (const std::size_t bytes : {32U, 31U}) {
        mrpt::io::CFileGZOutputStream(folder / "a_Images/0.bin").Write(xyzi.data(), bytes);
        io::ScanSource source(folder / "a.rawlog");
        std::size_t scans = 0;
        const std::string fault = faultOf(source, scans);
        EXPECT_EQ(scans, bytes / 32);
        EXPECT_EQ(fault.find("multiple of 16") != std::string::npos, bytes == 31) << fault;
    }
}

/** All that can be unpacked is there, and yet the end is not what gzip wrote. */
TEST(ScanSource, AChecksumThatIsWrongOrCutOffIsNoEndOfTheRawlog) {
    const test::TemporaryFolder folder;
    const std::string path = folder / "a.rawlog";
    writeRawlog<mrpt::io::CFileGZOutputStream>(path, {cloudObservation(0), cloudObservation(1)});
    const std::string whole = test::readText(path);
    for (std::size_t i = 1; i <= 8; ++i) {
        std::size_t scans = 0;
        test::writeText(path, whole.substr(0, whole.size() - i));
        io::ScanSource cut(path);
        EXPECT_NE(faultOf(cut, scans).find("after scan 1"), std::string::npos) << i;
        EXPECT_EQ(scans, 2U);

        // zlib keeps back the last of what it unpacked when the checksum is wrong.
        std::string damaged = whole;
        damaged[whole.size() - i] = static_cast<char>(damaged[whole.size() - i] ^ 1);
        test::writeText(path, damaged);
        io::ScanSource source(path);
        EXPECT_NE(faultOf(source, scans), "") << i;
    }
}

/** The count of a cloud's points is looked at before there is room made for them. */
TEST(ScanSource, ACloudThatClaimsTooManyPoints) {
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
        io::ScanSource source(path);
        std::size_t scans = 0;
        getrusage(RUSAGE_SELF, &before);
        EXPECT_NE(faultOf(source, scans).find("after scan 0"), std::string::npos);
        getrusage(RUSAGE_SELF, &after);
        EXPECT_EQ(scans, 1U);
        EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 200'000) << "kB";
    }
}

/** A bit of a rawlog is turned: whatever it hits, there is at most one Error, no crash and no
 *  object larger than memory is. */
TEST(ScanSource, DamagedBytes) {
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
            io::ScanSource source(folder / "damaged.rawlog");
            std::size_t scans = 0;
            const std::string fault = faultOf(source, scans);
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

TEST(ScanSource, RefusesWhatIsNoRawlog) {
    const test::TemporaryFolder folder;
    const auto fault = [&](const std::string& path) {
        try {
            io::ScanSource source(path);
            source.next();
        } catch (const Error& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    test::writeText(folder / "text.rawlog", "this is a letter, not a rawlog\n");
    test::writeText(folder / "empty.rawlog", "");
    EXPECT_NE(fault(folder / "text.rawlog").find("not a rawlog"), std::string::npos);
    EXPECT_NE(fault(folder / "empty.rawlog").find("empty"), std::string::npos);
    EXPECT_NE(fault(folder / "none.rawlog").find("no such file"), std::string::npos);
    EXPECT_NE(fault(folder.path()).find("no such file"), std::string::npos);
}
}  // namespace
