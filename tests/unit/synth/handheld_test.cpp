#include "handheld.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drive.h"
#include "indoor_scene.h"
#include "make_scene.h"
#include "ray_caster.h"
#include "scanner.h"
#include "scene_support.h"
#include "sweep.h"
#include "tile_window.h"

namespace {
using namespace delio;
using namespace delio::synth;
constexpr double kDegree = 3.14159265358979323846 / 180;

/** How the sensor is turned against the way, in degrees: yaw, pitch, roll. */
Eigen::Vector3d swing(const Scene& scene, const Drive& drive, double time_s) {
    const Eigen::Matrix3d R = drive.lidarPoseAt(time_s).linear();
    const double along = scene.road().path().at(drive.stationAt(time_s)).yaw;
    const double yaw = std::remainder(std::atan2(R(1, 0), R(0, 0)) - along, 360 * kDegree);
    return Eigen::Vector3d(yaw, std::asin(-R(2, 0)), std::atan2(R(2, 1), R(2, 2))) / kDegree;
}

TEST(SynthHandheld, SwingsBy15DegreesAt1500MillihertzInEveryScene) {
    for (const auto& name : sceneNames())
        for (const std::uint64_t seed : {1U, 2U}) {
            const auto scene = test::sceneOf(name, seed, 300);
            const Drive drive(scene->road(), 300, seed, Gait::kHandheld);
            Eigen::Vector3d most = Eigen::Vector3d::Zero(), before = swing(*scene, drive, 0);
            Eigen::Vector3d crossings = Eigen::Vector3d::Zero();
            for (int i = 1; i < 2900; ++i) {
                const Eigen::Vector3d now = swing(*scene, drive, 0.01 * i);
                most = most.cwiseMax(now.cwiseAbs());
                for (int axis = 0; axis < 3; ++axis)
                    crossings[axis] += now[axis] * before[axis] < 0 ? 1 : 0;
                before = now;
            }
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_NEAR(most[axis], Handheld::kSwing_deg, 2) << name << ", axis " << axis;
                EXPECT_NEAR(crossings[axis] / 2 / 29, Handheld::kSwing_Hz, 0.1) << name;
            }
        }
}

TEST(SynthHandheld, BobsBySomeCentimetresAtTheHeightOfAChest) {
    const auto scene = test::sceneOf("indoor", 3, 300);
    const Drive drive(scene->road(), 100, 3, Gait::kHandheld);
    double lowest = 10, highest = 0, aside = 0;
    for (double t = 0; t < 9; t += 0.01) {
        const Eigen::Vector3d place = drive.lidarPoseAt(t).translation();
        lowest = std::min(lowest, place.z());
        highest = std::max(highest, place.z());
        const Station at = scene->road().path().at(drive.stationAt(t));
        aside = std::max(aside, std::hypot(place.x() - at.x, place.y() - at.y));
    }
    EXPECT_NEAR((lowest + highest) / 2, 1.35, 0.02);
    EXPECT_NEAR(highest - lowest, 0.06, 0.01);
    EXPECT_GT(aside, 0.02);
    EXPECT_LT(aside, 0.05);
}

TEST(SynthHandheld, NobodyRunsWithASensorInTheHand) {
    for (const auto& name : sceneNames())
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            const auto scene = test::sceneOf(name, seed, 300);
            const Drive drive(scene->road(), 300, seed, Gait::kHandheld);
            double fastest = 0;
            for (std::size_t i = 1; i < 300; ++i)
                fastest = std::max(fastest, (drive.station(i) - drive.station(i - 1)) / 0.1);
            EXPECT_GT(fastest, 0.8) << name;
            EXPECT_LE(fastest, kFastestWalk_m_s + 1e-9) << name;
        }
}

TEST(SynthHandheld, TheSeedDecidesAndNothingElse) {
    const auto scene = test::sceneOf("forest", 5, 50);
    const Drive a(scene->road(), 50, 5, Gait::kHandheld), b(scene->road(), 40, 5, Gait::kHandheld);
    for (std::size_t i = 0; i < 40; ++i)
        EXPECT_TRUE(a.lidarPose(i).matrix() == b.lidarPose(i).matrix()) << i;
    EXPECT_FALSE(Handheld(5).at(1).isApprox(Handheld(6).at(1), 1e-3));
    const Drive vehicle(scene->road(), 50, 5), same(scene->road(), 50, 5, Gait::kVehicle);
    EXPECT_TRUE(vehicle.lidarPose(30).matrix() == same.lidarPose(30).matrix());
}

/** How far points on the floor are off it, at most, where nothing stands: along the walk. */
double offTheFloor(const ScanPoints& points, const Drive& drive, std::size_t scan, bool ownTime) {
    double most = 0;
    std::size_t used = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3d point =
            Eigen::Map<const Eigen::Vector3f>(&points.xyzi[4 * i]).cast<double>();
        const double time = ownTime ? static_cast<double>(points.time_s[i]) : 0;
        const double stamp = kScanPeriod_s * static_cast<double>(scan);
        const Eigen::Vector3d world = drive.lidarPoseAt(stamp + time) * point;
        if (std::abs(world.y()) > 0.4 || std::abs(world.z()) > 0.1) continue;
        if (world.x() < -20 || world.x() > 1.5) continue;
        most = std::max(most, std::abs(world.z()));
        ++used;
    }
    EXPECT_GT(used, 100U);
    return most;
}

TEST(SynthHandheld, EachPointIsSeenFromThePoseAtItsOwnTimeIfTheScanIsDistorted) {
    const IndoorScene scene(1, 10);
    const Drive drive(scene.road(), 20, 1, Gait::kHandheld);
    RayCaster caster;
    TileWindow(scene, caster).moveTo(0);
    const SensorModel sensor = sensorModels()[1];
    const Scanner scanner(caster, nullptr, sensor, {0, 0, false, 1, 1});
    const auto distorted = scanner.scan(sweepOf(drive, 3, sensor, true, 1), 3);
    EXPECT_LT(offTheFloor(distorted, drive, 3, true), 1e-5);
    EXPECT_GT(offTheFloor(distorted, drive, 3, false), 0.02);
    const auto still = scanner.scan(sweepOf(drive, 3, sensor, false, 1), 3);
    EXPECT_LT(offTheFloor(still, drive, 3, true), 1e-5);
}
}  // namespace
