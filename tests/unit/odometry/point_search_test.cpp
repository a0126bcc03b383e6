#include "odometry/search_points.h"

#include <gtest/gtest.h>

#include "core/voxel_grid.h"
#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using Eigen::Isometry3d;
using Eigen::Matrix3f;
using Eigen::Vector3d;
using odometry::PointMap;
using test::poseAt;

const test::Sensor kSensor{16, 900, -15, 15, 0.02};
const PointRegistrationOptions kOptions;

constexpr double kTurned_rad = 0.55;

Eigen::Matrix3Xd seenFrom(const test::Scene& scene, const Isometry3d& pose, double spacing,
                          test::Noise& noise) {
    return voxelCentroids(test::ringScan(scene, pose, kSensor, noise).points, spacing)
        .cast<double>();
}

/** A place, seen from its middle by a scan, and by one more. */
struct Pair {
    PointMap map{PointMapOptions{}};
    Eigen::Matrix3Xd scan;
};

Pair pairIn(const test::Scene& scene, const Isometry3d& moved, const test::Scene& later) {
    test::Noise noise;
    Pair pair;
    pair.map.add(seenFrom(scene, Isometry3d::Identity(), 0.1, noise));
    pair.scan = seenFrom(later, moved, 0.5, noise);
    return pair;
}
Pair pairIn(const test::Scene& scene, const Isometry3d& moved) {
    return pairIn(scene, moved, scene);
}

/** The yard with cars on both sides, so far from its middle. */
test::Scene traffic(double x) {
    test::Scene scene = test::yard();
    for (const double beside : {-4.5, 2.5})
        for (const double ahead : {-7.0, 0.0, 7.0})
            scene.push_back({{x + ahead, beside, -1.6}, {x + ahead + 4, beside + 2, -0.1}});
    return scene;
}

double offBy(const odometry::PointEstimate& found, const Isometry3d& truth) {
    return (found.pose.translation() - truth.translation()).norm();
}

// Rings on the ground lie on those of the scan before wherever the sensor stands.
TEST(PointSearch, RingsOnTheGroundDoNotHideAMotionOfMetres) {
    constexpr double kMistaken_m = 0.5, kFound_m = 0.25, kReach_m = 5;
    for (const auto& moved : {poseAt(4, 0, 0), poseAt(-2, 3, 0), poseAt(3, -2, 0, 0.05)}) {
        const Pair pair = pairIn(test::yard(), moved);
        const auto nearest = odometry::registerToPoints(pair.map, pair.scan, Isometry3d::Identity(),
                                                        kOptions.least_kernel, kOptions);
        EXPECT_GT(offBy(nearest, moved), kMistaken_m) << "nothing to search for";
        const auto found = odometry::searchPoints(pair.map, pair.scan, Isometry3d::Identity(),
                                                  {kReach_m, 0}, Matrix3f::Identity(), kOptions);
        EXPECT_TRUE(found.valid);
        EXPECT_LT(offBy(found, moved), kFound_m) << moved.translation().transpose();
    }
}

TEST(PointSearch, ATurnOfTwentyDegreesAboutAnyAxisIsFound) {
    constexpr double kFound_m = 0.1, kFound_deg = 1, kMistaken_deg = 3, kTurn = 0.35;
    for (const Vector3d& axis : {Vector3d(0, 0, 1), Vector3d(0, 1, 0), Vector3d(-1, 0, 0),
                                 Vector3d(1, -1, 1).normalized()}) {
        Isometry3d moved = poseAt(0.1, 0, 0);
        moved.linear() = rotationExp(kTurn * axis);
        const Pair pair = pairIn(test::yard(), moved);
        const auto nearest = odometry::registerToPoints(pair.map, pair.scan, Isometry3d::Identity(),
                                                        kOptions.least_kernel, kOptions);
        EXPECT_GT(test::degreesBetween(nearest.pose, moved), kMistaken_deg)
            << "nothing to search for";
        for (const double enough : {0.5, 2.0}) {  // with the first that fits, and by all of them
            const auto found = odometry::searchTurns(pair.map, pair.scan, Isometry3d::Identity(),
                                                     kTurned_rad, enough, kOptions);
            EXPECT_TRUE(found.valid);
            EXPECT_LT(offBy(found, moved), kFound_m) << axis.transpose();
            EXPECT_LT(test::degreesBetween(found.pose, moved), kFound_deg) << axis.transpose();
        }
    }
}

TEST(PointSearch, WhereNothingFitsNoTurnIsFound) {
    const Pair pair = pairIn(test::yard(), Isometry3d::Identity());
    const Eigen::Matrix3Xd far = pair.scan.colwise() + Vector3d(500, 0, 0);
    EXPECT_FALSE(
        odometry::searchTurns(pair.map, far, Isometry3d::Identity(), kTurned_rad, 0.5, kOptions)
            .valid);
}

// The disc of starts lies level, whatever the axes of the points.
TEST(PointSearch, TheDiscIsLevelWhereUprightSaysSo) {
    constexpr double kFound_m = 0.25, kReach_m = 5;
    const Isometry3d moved = poseAt(4, 0, 0);
    const Pair pair = pairIn(test::yard(), moved);
    const Eigen::Matrix3d rolled = Eigen::AngleAxisd(M_PI_2, Vector3d::UnitX()).toRotationMatrix();
    PointMap map(PointMapOptions{});
    test::Noise noise;
    map.add(
        rolled *
        test::ringScan(test::yard(), Isometry3d::Identity(), kSensor, noise).points.cast<double>());
    const auto found =
        odometry::searchPoints(map, rolled * pair.scan, Isometry3d::Identity(), {kReach_m, 0},
                               rolled.transpose().cast<float>(), kOptions);
    EXPECT_LT((rolled.transpose() * found.pose.translation() - moved.translation()).norm(),
              kFound_m);
}

TEST(PointSearch, AStandingSensorStands) {
    const Pair pair = pairIn(test::yard(), Isometry3d::Identity());
    const auto found = odometry::searchPoints(pair.map, pair.scan, Isometry3d::Identity(), {5, 0},
                                              Matrix3f::Identity(), kOptions);
    EXPECT_TRUE(found.valid);
    EXPECT_LT(offBy(found, Isometry3d::Identity()), 0.03);
}

// What is not explained where it stands is the cars', all of which have gone on alike.
TEST(PointSearch, ASensorBetweenCarsThatDriveOnStands) {
    for (const double driven : {0.8, 1.5, 3.0}) {
        const Pair pair = pairIn(traffic(0), Isometry3d::Identity(), traffic(driven));
        const auto found = odometry::searchPoints(pair.map, pair.scan, Isometry3d::Identity(),
                                                  {5, 0}, Matrix3f::Identity(), kOptions);
        EXPECT_TRUE(found.valid);
        EXPECT_LT(offBy(found, Isometry3d::Identity()), 0.03) << driven;
    }
}

TEST(PointSearch, PointsSeeAcrossACorridorAndNotAlongIt) {
    constexpr double kProbe_m = 0.5;
    test::Noise noise;
    PointMap map(PointMapOptions{});
    for (double x = 0; x < 3; x += 0.2) {
        const Isometry3d pose = poseAt(x, 0, 0);
        map.add(pose * seenFrom(test::corridor(), pose, 0.1, noise));
    }
    const Isometry3d pose = poseAt(1.5, 0, 0);
    const auto scan = seenFrom(test::corridor(), pose, 0.5, noise);
    const auto sees = [&](const Vector3d& axis) {
        return odometry::pointsSee(map, scan, pose, axis, kProbe_m, kOptions);
    };
    EXPECT_FALSE(sees(Vector3d::UnitX()));
    EXPECT_TRUE(sees(Vector3d::UnitY()));
    EXPECT_TRUE(sees(Vector3d::UnitZ()));
}
}  // namespace
