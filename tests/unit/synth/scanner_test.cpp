#include "scanner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tile_window.h"
#include "urban_scene.h"

namespace {
using namespace delio::synth;
constexpr double kDegree = 3.14159265358979323846 / 180;

SensorModel sensor(const std::string& option) {
    for (auto& model : sensorModels())
        if (model.option == option) return model;
    throw std::runtime_error("no sensor " + option);
}

Eigen::Vector3d pointOf(const ScanPoints& scan, std::size_t i) {
    return Eigen::Vector3f(scan.xyzi[4 * i], scan.xyzi[4 * i + 1], scan.xyzi[4 * i + 2])
        .cast<double>();
}

/** A street and a drive along it; what the tests put a sensor into. */
struct Street {
    UrbanScene scene{Road(urbanPath(1, 400), 1), 1};
    Drive drive{scene.road(), 200, 1};
    RayCaster caster;
    TileWindow window{scene, caster};
};

ScannerOptions exactOptions() {
    ScannerOptions options;
    options.noise_m = 0;
    return options;
}

TEST(SynthSweep, TurnsClockwiseFromTheBack) {
    EXPECT_DOUBLE_EQ(firingTime(0), 0);
    EXPECT_NEAR(firingTime(90 * kDegree), -0.025, 1e-12);  // left: before
    EXPECT_NEAR(firingTime(270 * kDegree), 0.025, 1e-12);  // right: after
    EXPECT_NEAR(firingTime(179.9 * kDegree), -0.05, 1e-4);
    EXPECT_NEAR(firingTime(180.1 * kDegree), 0.05, 1e-4);
}

TEST(SynthSweep, WithoutDistortionAllColumnsAreFiredAtTheStamp) {
    const Street street;
    const auto still = sweepOf(street.drive, 100, sensor("vlp16"), false, 1);
    const auto moving = sweepOf(street.drive, 100, sensor("vlp16"), true, 1);
    ASSERT_EQ(still.azimuth_rad.size(), 1808U);
    EXPECT_EQ(still.azimuth_rad, moving.azimuth_rad);
    for (std::size_t c = 0; c < still.azimuth_rad.size(); ++c) {
        EXPECT_EQ(still.time_s[c], 0);
        EXPECT_EQ(moving.time_s[c], firingTime(moving.azimuth_rad[c]));
        EXPECT_TRUE(still.lidarToWorld[c].isApprox(street.drive.lidarPose(100), 1e-15));
    }
    // The last column to the right of straight ahead is fired just after the stamp.
    EXPECT_GT(moving.time_s.back(), 0);
    EXPECT_LT(moving.time_s.back(), 1e-4);
}

TEST(SynthDrive, ThePoseBetweenScansGoesThroughThoseOfTheScans) {
    const Street street;
    for (const std::size_t scan : {0U, 1U, 57U, 199U}) {
        const double t = kScanPeriod_s * static_cast<double>(scan);
        EXPECT_TRUE(street.drive.lidarPoseAt(t).isApprox(street.drive.lidarPose(scan), 0));
        EXPECT_EQ(street.drive.stationAt(t), street.drive.station(scan));
    }
    for (double t = 0; t < 20.1; t += 0.01) {
        const double speed =
            (street.drive.stationAt(t + 1e-4) - street.drive.stationAt(t - 1e-4)) / 2e-4;
        EXPECT_GE(speed, 0);
        EXPECT_LT(speed, 13);
    }
}

TEST(SynthScanner, ADistortedPointLiesOnItsWallFromWhereItWasFired) {
    const Street street;
    constexpr std::size_t kScan = 100;
    const auto pose = street.drive.lidarPose(kScan);
    // Walls on both sides, ahead and behind, wide enough to be hit at all times.
    const std::vector<Eigen::Vector3d> normals = {pose.linear().col(1), -pose.linear().col(1),
                                                  pose.linear().col(0), -pose.linear().col(0)};
    Mesh mesh;
    const auto wall = [&](double x, double y, const Eigen::Vector3d& along) {
        const Eigen::Vector3d middle = pose * Eigen::Vector3d(x, y, 0);
        const Eigen::Vector3d u = pose.linear() * along, up = pose.linear().col(2) * 10;
        mesh.addQuad(middle - u - up, middle + u - up, middle + u + up, middle - u + up, 0.6);
    };
    wall(0, 8, {30, 0, 0});
    wall(0, -8, {30, 0, 0});
    wall(20, 0, {0, 30, 0});
    wall(-20, 0, {0, 30, 0});
    RayCaster caster;
    caster.add(0, mesh);
    caster.commit();
    const Scanner scanner(caster, nullptr, sensor("hdl32e"), exactOptions());
    const auto scan = scanner.scan(sweepOf(street.drive, kScan, sensor("hdl32e"), true, 1), kScan);
    ASSERT_GT(scan.size(), 40000U);
    const auto offWalls = [&](const Eigen::Vector3d& world) {
        const Eigen::Vector3d p = pose.inverse() * world;
        return std::min(std::abs(std::abs(p.y()) - 8), std::abs(std::abs(p.x()) - 20));
    };
    double worst = 0, worstUncorrected = 0;
    for (std::size_t i = 0; i < scan.size(); ++i) {
        const double t = kScanPeriod_s * kScan + static_cast<double>(scan.time_s[i]);
        worst = std::max(worst, offWalls(street.drive.lidarPoseAt(t) * pointOf(scan, i)));
        worstUncorrected = std::max(worstUncorrected, offWalls(pose * pointOf(scan, i)));
        const double azimuth = std::atan2(pointOf(scan, i).y(), pointOf(scan, i).x());
        EXPECT_NEAR(static_cast<double>(scan.time_s[i]), -azimuth / (2 * M_PI) * 0.1, 1e-4);
    }
    EXPECT_LT(worst, 1e-4);
    EXPECT_GT(worstUncorrected, 0.2);
}

TEST(SynthScanner, EachLaserKeepsItsBias) {
    Street street;
    street.window.moveTo(street.drive.station(60));
    const auto sweep = sweepOf(street.drive, 60, sensor("os1-64"), false, 1);
    auto biased = exactOptions();
    biased.ringBias_m = 0.03;
    const auto plain =
        Scanner(street.caster, nullptr, sensor("os1-64"), exactOptions()).scan(sweep, 60);
    const auto off = Scanner(street.caster, nullptr, sensor("os1-64"), biased).scan(sweep, 60);
    ASSERT_EQ(plain.size(), off.size());
    std::vector<double> bias(64, 0);
    for (std::size_t i = 0; i < off.size(); ++i) {
        ASSERT_EQ(plain.ring[i], off.ring[i]);
        const double difference = pointOf(off, i).norm() - pointOf(plain, i).norm();
        auto& expected = bias[off.ring[i]];
        if (expected == 0) expected = difference;
        EXPECT_NEAR(difference, expected, 2e-5);
    }
    double squares = 0;
    for (const double b : bias) squares += b * b / 64;
    EXPECT_NEAR(std::sqrt(squares), 0.03, 0.008);
}

TEST(SynthScanner, PointsOnTrafficAndOnlyTheyAreLabelled) {
    Street street;
    constexpr std::size_t kScan = 120;
    const Traffic traffic(street.scene.road(), street.drive, 20, 1);
    const TrafficCaster trafficCaster(traffic);
    street.window.moveTo(street.drive.station(kScan));
    const auto hdl64e = sensor("hdl64e");
    const Scanner scanner(street.caster, &trafficCaster, hdl64e, exactOptions());
    const auto scan = scanner.scan(sweepOf(street.drive, kScan, hdl64e, true, 1), kScan);
    std::size_t moving = 0, wrong = 0;
    for (std::size_t i = 0; i < scan.size(); i += scan.label[i] == 1 ? 1 : 3) {
        const double t = kScanPeriod_s * kScan + static_cast<double>(scan.time_s[i]);
        const Eigen::Vector3d world = street.drive.lidarPoseAt(t) * pointOf(scan, i);
        const bool labelled = scan.label[i] == 1;
        moving += labelled ? 1 : 0;
        bool inside = false;
        for (std::size_t m = 0; m < traffic.size(); ++m) {
            const Eigen::Isometry3d pose = traffic.pose(m, t);
            if ((pose.translation() - world).squaredNorm() > 25) continue;
            Eigen::AlignedBox3d box = traffic.looks(m).box;
            const Eigen::Vector3d grown = Eigen::Vector3d::Constant(labelled ? 1e-3 : -0.02);
            box.min() -= grown;
            box.max() += grown;
            if (!labelled) box.min().z() = 0.1;  // the ground under it stands still
            inside |= box.contains(pose.inverse() * world);
        }
        wrong += inside != labelled ? 1 : 0;
    }
    EXPECT_EQ(wrong, 0U);
    EXPECT_GT(moving, 1500U);
    EXPECT_LT(moving, scan.size() / 3);
}
}  // namespace
