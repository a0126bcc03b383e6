#include "delio/recordings/rawlog_reader.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CSensoryFrame.h>

#include "delio/core/geometry.h"
#include "rawlog_files.h"

namespace {
using namespace delio;
using namespace delio::rawlog_test;

TEST(RawlogReader, BareFramedAndActionFramedScansComeInOrder) {
    const test::TemporaryFolder folder;
    auto frame = mrpt::obs::CSensoryFrame::Create();
    frame->insert(cloudObservation(1));
    frame->insert(cloudObservation(7, "other"));
    writeRawlog(folder / "a.rawlog",
                {cloudObservation(0), frame, mrpt::obs::CActionCollection::Create(),
                 mrpt::obs::CObservationIMU::Create(), cloudObservation(2)});
    writeEpoch(folder / "a.rawlog", 1000);
    io::RawlogReader reader(folder / "a.rawlog");
    for (std::size_t i = 0; i < 3; ++i) {
        const auto scan = reader.next();
        ASSERT_TRUE(scan);
        EXPECT_EQ(scan->index, i);
        EXPECT_DOUBLE_EQ(scan->stamp_s, 0.1 * static_cast<double>(i));
        EXPECT_EQ(scan->points->getPointsBufferRef_x()[0], static_cast<float>(i));
        EXPECT_EQ(scan->sensorPose.matrix(), fromMrpt(kOnTheRoof).matrix());
    }
    EXPECT_FALSE(reader.next());
    EXPECT_FALSE(reader.next());
    EXPECT_EQ(reader.label(), "lidar");
    EXPECT_EQ(reader.otherLabels(), std::set<std::string>{"other"});
    EXPECT_DOUBLE_EQ(reader.fraction().value(), 1);

    io::RawlogReader other(folder / "a.rawlog", "other");
    ASSERT_TRUE(other.skip());
    EXPECT_FALSE(other.skip());
    io::RawlogReader none(folder / "a.rawlog", "nothing");
    EXPECT_FALSE(none.next());
}

TEST(RawlogReader, DepthCamerasAndCloudsWithoutPoints) {
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
    io::RawlogReader reader(folder / "a.rawlog");
    const auto scan = reader.next();
    ASSERT_TRUE(scan);
    ASSERT_EQ(scan->points->size(), 2U);
    EXPECT_EQ(scan->points->getPointsBufferRef_x()[1], 5);
    EXPECT_EQ(reader.next()->points->size(), 0U);
}

TEST(RawlogReader, LabelsAndFractionOfPlainAndCompressedRawlogs) {
    const test::TemporaryFolder folder;
    std::vector<mrpt::serialization::CSerializable::Ptr> objects;
    objects.reserve(6);
    for (int scan = 0; scan < 6; ++scan)
        objects.push_back(cloudObservation(scan, scan % 3 == 1 ? "second" : "first"));
    writeRawlog(folder / "plain.rawlog", objects);
    writeRawlog<mrpt::io::CFileGZOutputStream>(folder / "gz.rawlog", objects);
    for (const std::string name : {"plain.rawlog", "gz.rawlog"}) {
        writeEpoch(folder / name, 1000);
        io::RawlogReader reader(folder / name, "second");
        EXPECT_EQ(reader.fraction(), name == "gz.rawlog" ? std::nullopt : std::optional(0.0));
        for (const int of : {1, 4}) {
            const auto scan = reader.next();
            ASSERT_TRUE(scan);
            EXPECT_EQ(scan->points->getPointsBufferRef_x()[0], static_cast<float>(of));
            EXPECT_NEAR(scan->stamp_s, 0.1 * of, 5.1e-8);
            if (name == "gz.rawlog")
                EXPECT_FALSE(reader.fraction());
            else
                EXPECT_NEAR(reader.fraction().value(), (of + 1) / 6.0, 0.01);
        }
        EXPECT_FALSE(reader.next());
        EXPECT_EQ(reader.otherLabels(), std::set<std::string>{"first"});
    }
}

/** To MRPT's tick of 100 ns, however large the epoch's own digits are. */
TEST(RawlogReader, TimesAreCountedFromAnEpochThatIsNoWholeSecond) {
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
    writeEpoch(folder / "a.rawlog", 1317042145.951199);
    io::RawlogReader reader(folder / "a.rawlog");
    for (int scan = 0; scan < 20; ++scan)
        EXPECT_NEAR(reader.next()->stamp_s, 1033217e-7 * scan, 2.5e-7 / 2);
}

TEST(RawlogReader, RefusesWhatIsNoRawlog) {
    const test::TemporaryFolder folder;
    const auto fault = [&](const std::string& path) {
        try {
            io::RawlogReader reader(path);
            reader.next();
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

TEST(RawlogReader, TellsWhatIsKnownOfTheDrive) {
    const test::TemporaryFolder folder;
    const std::string rawlog = folder / "a.rawlog";
    writeRawlog(rawlog, {cloudObservation(0)});
    const auto bare = io::openScans(rawlog);
    EXPECT_FALSE(bare->meta());
    EXPECT_DOUBLE_EQ(bare->next()->stamp_s, 1000) << "Unix time";

    io::DriveMeta meta;
    meta.sensorModel = "HDL-64E";
    meta.verticalCorrectionDeg = 0.205;
    meta.epoch_s = 999;
    test::writeText(io::sidecarPath(rawlog, ".meta.yaml"), io::textOf(meta));
    const auto told = io::openScans(rawlog);
    ASSERT_TRUE(told->meta());
    EXPECT_EQ(told->meta()->sensorModel, "HDL-64E");
    EXPECT_EQ(told->meta()->verticalCorrectionDeg, 0.205);
    EXPECT_DOUBLE_EQ(told->next()->stamp_s, 1);

    test::writeText(folder / "a.meta.yaml", "sensor_modell: HDL-64E");
    EXPECT_THROW(io::openScans(rawlog), Error);
}
}  // namespace
