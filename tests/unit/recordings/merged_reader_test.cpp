// Several LiDARs in one scan.
#include "recordings/merged_reader.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationIMU.h>

#include "delio/core/geometry.h"
#include "rawlog_files.h"

namespace {
using namespace delio;
using namespace delio::rawlog_test;
using mrpt::poses::CPose3D;

/** Two sensors: `front` measures 10 points in each turn of 0.1 s, which begins at the stamp, and so
 *  does `back`, which is 1 m behind it, and 0.045 s later. The x of a point is its time. */
class Merged : public testing::Test {
 protected:
    void add(const std::string& label, double begin_s, const CPose3D& pose, bool timed = true) {
        constexpr int kPoints = 10;
        std::vector<float> xyzi, times;
        for (int i = 0; i < kPoints; ++i) {
            times.push_back(0.01F * static_cast<float>(i));
            xyzi.insert(xyzi.end(), {static_cast<float>(begin_s) + times.back(), 5, 0, 1});
        }
        const std::string stem = label + std::to_string(objects_.size());
        const std::filesystem::path images = io::sidecarPath(rawlog_, "_Images");
        std::filesystem::create_directories(images);
        writeValues(images / (stem + ".bin"), xyzi);
        if (timed) writeValues(images / (stem + ".time"), times);
        auto cloud = CObservationPointCloud::Create();
        cloud->sensorLabel = label;
        cloud->sensorPose = pose;
        cloud->timestamp = mrpt::Clock::fromDouble(1000 + begin_s);
        cloud->setAsExternalStorage(stem + ".bin",
                                    CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
        objects_.push_back(cloud);
    }
    void addDrive(int scans, bool timed = true) {
        for (int i = 0; i < scans; ++i) {
            if (i < missingFrom_ || i >= missingTo_) add("front", 0.1 * i, kFront, timed);
            add("back", 0.1 * i + 0.045, kBack, timed);
        }
    }
    std::unique_ptr<io::ScanReader> open(const std::string& label = "front,back",
                                         const std::string& extrinsics = "") {
        writeRawlog(rawlog_, objects_);
        writeEpoch(rawlog_, 1000);
        io::ScanSource source{rawlog_, label, "", ""};
        if (!extrinsics.empty()) {
            source.extrinsicsFile = folder_ / "poses.txt";
            test::writeText(source.extrinsicsFile, extrinsics);
        }
        return io::openScans(source);
    }
    std::string faultOf(const std::string& label, const std::string& extrinsics = "") {
        try {
            open(label, extrinsics);
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    }
    static std::size_t from(const Scan& scan, float y) {
        const auto& all = scan.points->getPointsBufferRef_y();
        return static_cast<std::size_t>(std::count_if(
            all.begin(), all.end(), [&](float it) { return std::abs(it - y) < 1e-4F; }));
    }

    const CPose3D kFront{2, 0, 1, 0, 0, 0}, kBack{2, -1, 1, 0, 0, 0};
    test::TemporaryFolder folder_;
    std::string rawlog_ = folder_ / "two.rawlog";
    int missingFrom_ = 1000, missingTo_ = 1000;
    std::vector<mrpt::serialization::CSerializable::Ptr> objects_;
};

TEST_F(Merged, PointsAreTakenByTheirOwnTimesInTheFirstSensorsFrame) {
    addDrive(6);
    const auto reader = open();
    EXPECT_EQ(reader->label(), "front,back");
    EXPECT_TRUE(reader->otherLabels().empty());
    for (std::size_t i = 0; i < 6; ++i) {
        const auto scan = reader->next();
        ASSERT_TRUE(scan);
        EXPECT_EQ(scan->index, i);
        EXPECT_NEAR(scan->stamp_s, 0.1 * static_cast<double>(i), 1e-6);
        EXPECT_TRUE(scan->sensorPose.isApprox(fromMrpt(kFront), 1e-9));
        EXPECT_EQ(from(*scan, 5), 10U);  // of `front`
        // Of `back`, in the frame of `front`. The last scan gets all that is left.
        EXPECT_EQ(from(*scan, 4), i == 0 ? 6U : i == 5 ? 14U : 10U);
        ASSERT_EQ(scan->times_s.size(), scan->points->size());
        const auto& x = scan->points->getPointsBufferRef_x();
        for (std::size_t k = 0; k < x.size(); ++k) {
            EXPECT_NEAR(scan->stamp_s + scan->times_s[k], x[k], 1e-5);
            EXPECT_GE(scan->times_s[k], 0);
            EXPECT_LT(scan->times_s[k], i == 5 ? 0.14F : 0.1F);
        }
    }
    EXPECT_FALSE(reader->next());
}

TEST_F(Merged, ASensorThatStopsIsReplacedAndNamed) {
    missingFrom_ = 10;
    missingTo_ = 20;
    addDrive(30);
    const auto reader = open();
    std::size_t scans = 0, withoutFront = 0;
    double latest_s = -1;
    while (const auto scan = reader->next()) {
        EXPECT_EQ(scan->index, scans++);
        EXPECT_GT(scan->stamp_s, latest_s);
        EXPECT_LT(scan->stamp_s - latest_s, latest_s < 0 ? 2 : 0.2);
        latest_s = scan->stamp_s;
        EXPECT_TRUE(scan->sensorPose.isApprox(fromMrpt(kFront), 1e-9));
        withoutFront += from(*scan, 5) == 0;
        EXPECT_GT(from(*scan, 4), 0U);
    }
    EXPECT_GE(scans, 29U);
    EXPECT_GE(withoutFront, 8U);
    bool isNamed = false;
    for (const auto& finding : reader->recording().findings)
        isNamed =
            isNamed || finding.find("the sensor 'front' sent nothing from scan 10 to scan") == 0;
    EXPECT_TRUE(isNamed);
}

TEST_F(Merged, ASensorThatEndsIsNamed) {
    missingFrom_ = 10;
    addDrive(30);
    const auto reader = open("back,front");
    std::size_t scans = 0;
    while (reader->next()) ++scans;
    EXPECT_EQ(scans, 30U);
    const auto findings = reader->recording().findings;
    ASSERT_EQ(findings.size(), 1U);
    EXPECT_EQ(findings[0], "the sensor 'front' sent nothing from scan 10 on");
}

TEST_F(Merged, WithoutPointTimesScansGoToTheNearestStamp) {
    addDrive(6, false);
    const auto reader = open("all");
    while (const auto scan = reader->next()) {
        EXPECT_TRUE(scan->times_s.empty());
        EXPECT_EQ(from(*scan, 5), 10U);
        EXPECT_EQ(from(*scan, 4), 10U);
    }
    ASSERT_EQ(reader->recording().findings.size(), 1U);
    EXPECT_NE(reader->recording().findings[0].find("differ by more than 5 ms"), std::string::npos);
}

TEST_F(Merged, PosesOfAFile) {
    addDrive(3);
    const std::string poses = "# mast\nfront 0 0 3 90 0 0\nback 0 2 3 90 0 0\n";
    const auto both = open("all", poses)->next();
    // 2 m along the vehicle's y are 2 m along the x of `front`.
    EXPECT_TRUE(both->sensorPose.isApprox(fromMrpt(CPose3D(0, 0, 3, M_PI / 2, 0, 0)), 1e-9));
    EXPECT_EQ(from(*both, 5), 16U);
    EXPECT_NEAR(both->points->getPointsBufferRef_x()[10], 2.045F, 1e-5F);
    const auto one = open("back", poses)->next();
    EXPECT_EQ(one->points->size(), 10U);
    EXPECT_TRUE(one->sensorPose.isApprox(fromMrpt(CPose3D(0, 2, 3, M_PI / 2, 0, 0)), 1e-9));
}

TEST_F(Merged, TheFilesImuReplacesTheRecordings) {
    addDrive(3);
    auto imu = mrpt::obs::CObservationIMU::Create();
    imu->sensorLabel = "imu";
    imu->timestamp = mrpt::Clock::fromDouble(1000.05);
    imu->set(mrpt::obs::IMU_WX, 1.0);
    imu->set(mrpt::obs::IMU_WY, 0.0);
    imu->set(mrpt::obs::IMU_WZ, 0.0);
    objects_.insert(objects_.begin() + 1, imu);
    const auto reader = open("front", "imu 1 2 3 90 0 0 -0.03");
    while (reader->next()) continue;
    const auto samples = reader->takeImu();
    ASSERT_EQ(samples.size(), 1U);
    ASSERT_TRUE(samples[0].sensorPose && samples[0].offset_s);
    EXPECT_TRUE(samples[0].sensorPose->isApprox(fromMrpt(CPose3D(1, 2, 3, M_PI / 2, 0, 0)), 1e-9));
    EXPECT_EQ(*samples[0].offset_s, -0.03);
    EXPECT_NEAR(samples[0].stamp_s, 0.05, 1e-6);
}

TEST_F(Merged, Errors) {
    addDrive(3);
    const std::string file = "'" + rawlog_ + "': ";
    EXPECT_EQ(faultOf("front,roof"),
              file + "no scans of the sensor 'roof', only of 'back', 'front'");
    EXPECT_EQ(faultOf("front,front"),
              "the sensor 'front' is chosen twice: --sensor-label front,front");
    EXPECT_EQ(faultOf("front,"), "a name is missing between commas: --sensor-label front,");
    EXPECT_EQ(faultOf("all", "front 0 0 0 0 0 0\n"),
              file + "the extrinsics have no pose of the sensor 'back'");
    for (const char* line : {"front 0 0 0 0 0", "front 0 0 0 0 0 x", "front 0 0 nan 0 0 0"})
        EXPECT_NE(faultOf("all", line).find("line 1: expected LABEL x y z yaw pitch roll"),
                  std::string::npos);
    for (const char* twice :
         {"front 0 0 0 0 0 0\nfront 0 0 0 0 0 0\n", "imu 0 0 0 0 0 0\nimu 0 0 0 0 0 0"})
        EXPECT_NE(faultOf("all", twice).find("is there twice"), std::string::npos);
    EXPECT_NE(faultOf("all", "# nothing").find("has no pose of a sensor"), std::string::npos);
    EXPECT_NE(faultOf("all", "front 0 0 0 0 0 0 0.01").find("expected LABEL"), std::string::npos);
    for (const char* offset : {"imu 0 0 0 0 0 0 x", "imu 0 0 0 0 0 0 0.2", "imu 0 0 0 0 0 0 nan"})
        EXPECT_NE(faultOf("all", offset).find("line 1: the offset of an IMU's clock"),
                  std::string::npos);
}

TEST_F(Merged, EqualPosesAreDoubted) {
    add("front", 0, kFront);
    add("back", 0, kFront);
    const auto warnings = open("all")->recording().warnings;
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("--extrinsics"), std::string::npos);
}
}  // namespace
