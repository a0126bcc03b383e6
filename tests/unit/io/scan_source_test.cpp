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
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include <fstream>

#include "delio/error.h"
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
