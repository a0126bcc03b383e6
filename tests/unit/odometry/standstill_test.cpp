#include <gtest/gtest.h>

#include "odometry/local_map.h"
#include "odometry_drive.h"

// A sensor that stands is recognised as such, and not where a moving one would see the same.
namespace {
using namespace delio;
using namespace delio::odometry_test;

const test::Sensor kVlp16{16, 900, -15, 15, 0.01};

/** Twelve scans, each `step_m` along x after the one before. */
std::vector<Step> drive(const test::Scene& scene, double step_m, const test::Sensor& sensor) {
    std::vector<Scan> scans;
    test::Noise noise;
    for (int i = 0; i < 12; ++i) {
        const auto pose = test::poseAt(step_m * i, 0, 0);
        scans.push_back(test::scanOf(test::ringScan(scene, pose, sensor, noise).points));
        scans.back().stamp_s = 0.1 * i;
    }
    return stepsOf(scans, quick("accurate"));
}

bool isOpenAlongX(const Step& step) {
    const auto& axes = step.quality.unobservedTranslation;
    return axes.cols() > 0 && axes.row(0).cwiseAbs().maxCoeff() > 0.9;
}

TEST(Standstill, IsSeenByASparseSensorInARoomAndInTheYard) {
    for (const auto& scene : {test::room(), test::yard()}) {
        const auto steps = drive(scene, 0, kVlp16);
        for (std::size_t i = 1; i < steps.size(); ++i) {
            EXPECT_FALSE(steps[i].predicted) << i;
            EXPECT_TRUE(steps[i].standing) << i;
            EXPECT_EQ(steps[i].quality.unobservedTranslation.cols(), 0) << i;
            EXPECT_LT(steps[i].increment.pose.translation().norm(), 0.01) << i;
        }
    }
}

TEST(Standstill, IsNotClaimedWhereAMovingSensorWouldSeeTheSame) {
    for (const auto& scene : {test::corridor(), test::highway(false)})
        for (const double step_m : {0.0, 0.1, 1.0})
            for (const auto& sensor : {kVlp16, test::Sensor{48, 900, -24, 8, 0.01}}) {
                SCOPED_TRACE(testing::Message() << scene.size() << " blocks, " << step_m << " m, "
                                                << sensor.rings << " rings");
                const auto steps = drive(scene, step_m, sensor);
                for (std::size_t i = 1; i < steps.size(); ++i) {
                    EXPECT_FALSE(steps[i].standing) << i;
                    EXPECT_TRUE(steps[i].predicted || isOpenAlongX(steps[i])) << i;
                }
            }
}

// They are most of what it sees: the sensor seems to stand among them.
TEST(Standstill, AmongVehiclesOfItsOwnSpeedIsDoubtful) {
    constexpr double kStep_m = 0.9;
    constexpr std::size_t kFrom = 8;
    std::vector<Scan> scans;
    test::Noise noise;
    for (int i = 0; i < 14; ++i) {
        const double x = kStep_m * i;
        test::Scene scene = test::highway(true);
        for (const double y : {3.0, -5.0}) scene.push_back({{x - 7, y, -1.8}, {x + 6, y + 2, 1.2}});
        for (const double ahead : {9.0, -16.0})
            scene.push_back({{x + ahead, -1.2, -1.8}, {x + ahead + 6, 1.2, 1.2}});
        scans.push_back(
            test::scanOf(test::ringScan(scene, test::poseAt(x, 0, 0), kVlp16, noise).points));
        scans.back().stamp_s = 0.1 * i;
    }
    const auto steps = stepsOf(scans, quick("accurate"));
    for (std::size_t i = kFrom; i < steps.size(); ++i) {
        const bool isRight = std::abs(steps[i].increment.pose.translation().x() - kStep_m) < 0.1;
        EXPECT_FALSE(steps[i].standing) << i;
        EXPECT_TRUE(isRight || isOpenAlongX(steps[i])) << i;
    }
}

/** Walls across the x axis at these distances, 4 m wide and 2 m high, as points 0.2 m apart. */
Eigen::Matrix3Xd wallsAt(const std::vector<double>& x) {
    Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(x.size()) * 20 * 10);
    Eigen::Index i = 0;
    for (const double distance : x)
        for (int y = 0; y < 20; ++y)
            for (int z = 0; z < 10; ++z) points.col(i++) << distance, 0.2 * (y - 10), 0.2 * (z - 5);
    return points;
}

bool standsBetween(const std::vector<double>& walls, double moved_m, bool isVertical) {
    odometry::PointMap map{PointMapOptions{}};
    map.add(wallsAt(walls));
    paper::SurfaceNormals scan;
    scan.points = wallsAt(walls).cast<float>();
    scan.directions = Eigen::Vector3f::UnitX().replicate(1, scan.points.cols());
    return showsStandstill(map, scan, test::poseAt(moved_m, 0, 0),
                           {Eigen::Vector3d::UnitX(), isVertical, 0.5, 0.1});
}

// A vehicle that keeps its distance ahead looks the same, too; nothing does so above or below.
TEST(Standstill, NeedsSurfacesOnMoreThanOneSide) {
    EXPECT_TRUE(standsBetween({-10, 12}, 0, false));
    EXPECT_FALSE(standsBetween({12}, 0, false));
    EXPECT_TRUE(standsBetween({12}, 0, true));
    EXPECT_FALSE(standsBetween({-10, 12}, 0.05, false));
    EXPECT_FALSE(standsBetween({-10, 12}, 0.3, false));
    // Here a motion by the probe leads onto other walls.
    EXPECT_FALSE(standsBetween({-10.5, -10, -9.5, 9.5, 10, 10.5}, 0, false));
}

TEST(Standstill, EndsWithTheFirstMotion) {
    std::vector<Scan> scans;
    test::Noise noise;
    for (int i = 0; i < 12; ++i) {
        const auto pose = test::poseAt(i < 6 ? 0 : 0.1 * (i - 5), 0, 0);
        scans.push_back(test::scanOf(test::ringScan(test::yard(), pose, kVlp16, noise).points));
        scans.back().stamp_s = 0.1 * i;
    }
    const auto steps = stepsOf(scans, quick("accurate"));
    for (std::size_t i = 1; i < steps.size(); ++i) EXPECT_EQ(steps[i].standing, i < 6) << i;
    EXPECT_NEAR(steps[8].increment.pose.translation().x(), 0.1, 0.02);
}
}  // namespace
