// Parts of the own vehicle: what stays where it is in the sensor's frame.
#include "odometry/own_vehicle.h"

#include <gtest/gtest.h>

#include <utility>

#include "ring_scan.h"

namespace {
using namespace delio;
using namespace delio::odometry;
using test::Noise;
using test::poseAt;

/** A mast, 1.2 m high and 3.5 m behind the sensor. */
Eigen::Matrix3Xf mast(Noise& noise) {
    Eigen::Matrix3Xf points(3, 40);
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        points.col(i) = Eigen::Vector3f(-3.5F, 0.4F, -1.0F + 0.03F * static_cast<float>(i)) +
                        0.02F * noise.normals().cast<float>();
    return points;
}

class OwnVehicleTest : public testing::Test {
 protected:
    /** Drives along x, 0.6 m from scan to scan. */
    void drive(const test::Scene& scene, int scans, bool hasMast) {
        for (int i = 0; i < scans; ++i) {
            const auto pose = poseAt(0.6 * i, 0, 0);
            auto points = test::ringScan(scene, pose, {}, noise_).points;
            if (hasMast) {
                const auto own = mast(noise_);
                points.conservativeResize(3, points.cols() + own.cols());
                points.rightCols(own.cols()) = own;
            }
            own_.add(points, Eigen::Matrix3f::Identity(), pose);
        }
    }
    Noise noise_;
    OwnVehicle own_;
};

TEST_F(OwnVehicleTest, AMastIsFoundAndDropped) {
    drive(test::corridor(), 79, true);
    EXPECT_TRUE(own_.box().isEmpty());
    drive(test::corridor(), 5, true);
    ASSERT_FALSE(own_.box().isEmpty());
    EXPECT_TRUE(own_.box().contains(Eigen::Vector3d(-3.5, 0.4, -0.5)));
    EXPECT_LT(own_.box().sizes().maxCoeff(), 2);
    PointCloud cloud;
    cloud.points = mast(noise_);
    const auto count = cloud.points.cols();
    cloud.points.conservativeResize(3, count + 2);
    cloud.points.rightCols(2) << 3.5F, -3.5F, 0.4F, 4.5F, -0.5F, -0.5F;
    for (std::uint32_t i = 0; i < count + 2; ++i) {
        cloud.indices.push_back(i);
        cloud.times_s.push_back(0.001F * static_cast<float>(i));
    }
    cloud = own_.without(std::move(cloud));
    ASSERT_EQ(cloud.points.cols(), 2);
    EXPECT_EQ(cloud.indices, (std::vector<std::uint32_t>{40, 41}));
    EXPECT_EQ(cloud.times_s, (std::vector<float>{0.04F, 0.041F}));
    EXPECT_EQ(cloud.outOfRange, 40U);
}

// Walls and rails that look the same from anywhere on the road.
TEST_F(OwnVehicleTest, TheWorldIsNotTheVehicle) {
    for (const auto& scene : {test::corridor(), test::highway(false), test::highway(true)}) {
        own_ = OwnVehicle();
        drive(scene, 200, false);
        EXPECT_TRUE(own_.box().isEmpty());
    }
}

TEST_F(OwnVehicleTest, NothingIsFoundWhileTheSensorStands) {
    for (int i = 0; i < 200; ++i)
        own_.add(mast(noise_), Eigen::Matrix3f::Identity(), poseAt(1, 0, 0));
    EXPECT_TRUE(own_.box().isEmpty());
}
}  // namespace
