// Points of the own vehicle.
#include <gtest/gtest.h>

#include "delio/core/geometry.h"
#include "rawlog_files.h"

namespace {
using namespace delio;
using namespace delio::rawlog_test;

/** Points of scan `scan`: x = scan, y = 0, 1, 2, ... 49, z = -1.5, seen from the roof. */
class VehicleBox : public testing::Test {
 protected:
    void SetUp() override {
        std::vector<mrpt::serialization::CSerializable::Ptr> objects;
        for (int scan = 0; scan < 3; ++scan) objects.push_back(cloudObservation(scan));
        writeRawlog(rawlog_, objects);
        const auto images = std::filesystem::path(io::sidecarPath(rawlog_, "_Images"));
        std::filesystem::create_directory(images);
        std::vector<float> times;
        for (int i = 0; i < 50; ++i) times.push_back(0.001F * static_cast<float>(i));
        writeValues(images / "000000.time", times);
    }
    std::unique_ptr<io::ScanReader> open(const Eigen::AlignedBox3d& box) const {
        io::ScanSource source{rawlog_, "", "", ""};
        source.vehicleBox = box;
        return io::openScans(source);
    }
    test::TemporaryFolder folder_;
    std::string rawlog_ = folder_ / "d.rawlog";
};

TEST_F(VehicleBox, IsInTheVehiclesFrame) {
    const Eigen::Vector3d tenth = fromMrpt(kOnTheRoof) * Eigen::Vector3d(0, 10, -1.5);
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.3);
    const auto reader = open({tenth - half, tenth + half});
    const auto first = reader->next(), second = reader->next();
    ASSERT_EQ(first->points->size(), 49U);
    EXPECT_EQ(first->points->getPointsBufferRef_y()[9], 9);
    EXPECT_EQ(first->points->getPointsBufferRef_y()[10], 11);
    ASSERT_EQ(first->times_s.size(), 49U);
    EXPECT_FLOAT_EQ(first->times_s[10], 0.011F);
    EXPECT_EQ(second->points->size(), 50U);
    EXPECT_TRUE(reader->recording().findings.empty());
}

TEST_F(VehicleBox, WithoutPointsIsDoubted) {
    const auto reader = open({Eigen::Vector3d(500, 0, 0), Eigen::Vector3d(501, 1, 1)});
    while (const auto scan = reader->next()) EXPECT_EQ(scan->points->size(), 50U);
    ASSERT_EQ(reader->recording().findings.size(), 1U);
    EXPECT_NE(reader->recording().findings[0].find("vehicle box"), std::string::npos);
}
}  // namespace
