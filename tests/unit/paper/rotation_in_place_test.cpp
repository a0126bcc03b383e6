#include "paper/rotation_in_place.h"

#include <gtest/gtest.h>

#include <vector>

#include "delio/core/error.h"
#include "paper/pattern_registration.h"
#include "poses.h"
#include "ring_scan.h"

namespace {
using namespace delio;
using paper::Pattern;

/** A road over a crest (radius 200 m) between two walls with pillars, as seen from `pose`: what
 *  lies within 15 m of it, with the normals of the surfaces. */
Pattern crestSeenFrom(const Eigen::Isometry3d& pose) {
    std::vector<Eigen::Vector3d> points, normals;
    const auto see = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
        if ((p - pose.translation()).norm() > 15) return;
        points.push_back(pose.inverse() * p);
        normals.push_back(pose.linear().transpose() * n.normalized());
    };
    for (double x = -20; x < 25; x += 0.4) {
        const double ground = -1.8 - x * x / 400;
        for (double y = -8; y < 8; y += 0.4) see({x, y, ground}, {x / 200, 0, 1});
        for (double z = 0; z < 3; z += 0.4) {
            see({x, 8, ground + z}, {0, -1, 0});
            see({x, -8, ground + z}, {0, 1, 0});
        }
    }
    for (double x = -18; x < 20; x += 6)
        for (double z = 0; z < 3; z += 0.4)
            for (double y = 6; y < 8; y += 0.4) see({x, y, z - 1.8}, {-1, 0, 0});
    Pattern pattern;
    const auto count = static_cast<Eigen::Index>(points.size());
    pattern.directions.resize(3, count);
    pattern.points.resize(3, count);
    for (Eigen::Index i = 0; i < count; ++i) {
        pattern.points.col(i) = points[static_cast<std::size_t>(i)].cast<float>();
        pattern.directions.col(i) = normals[static_cast<std::size_t>(i)].cast<float>();
    }
    pattern.weights.setOnes(count);
    pattern.normals = points.size();
    return pattern;
}

/** Downhill from the crest by 1.5 m: the vehicle pitches with the road. */
Eigen::Isometry3d onwards() {
    return test::poseAtDeg(1.5, 0, -1.5 * 1.5 / 400, 0, 1.5 / 200 * 180 / M_PI);
}

TEST(RotationInPlace, SeesThePitchThatThePatternTakesAlong) {
    const Pattern from = crestSeenFrom(Eigen::Isometry3d::Identity());
    const Pattern to = crestSeenFrom(onwards());
    const auto pattern = paper::registerPatterns(from, to, Eigen::Matrix3d::Identity(), {});
    EXPECT_GT(test::degreesBetween(pattern.rotation, Eigen::Matrix3d(onwards().linear())), 0.2);
    const auto found = paper::registerInPlace(from, to, pattern, onwards().translation(), {});
    EXPECT_LT(test::degreesBetween(found.rotation, Eigen::Matrix3d(onwards().linear())), 0.05);
    EXPECT_GT(found.matches, 1000U);
    EXPECT_EQ(found.covariance, pattern.covariance);
}

TEST(RotationInPlace, LeavesOpenAxesAlone) {
    const Pattern from = crestSeenFrom(Eigen::Isometry3d::Identity());
    const Pattern to = crestSeenFrom(onwards());
    auto pattern = paper::registerPatterns(from, to, Eigen::Matrix3d::Identity(), {});
    pattern.unobservedAxes = Eigen::Vector3d::UnitY();
    const auto found = paper::registerInPlace(from, to, pattern, onwards().translation(), {});
    const Eigen::AngleAxisd turn(pattern.rotation.transpose() * found.rotation);
    EXPECT_NEAR(turn.angle() * turn.axis().y(), 0, 1e-9);
}

TEST(RotationInPlace, WithoutPairsThePatternsRotationStays) {
    Pattern from = crestSeenFrom(Eigen::Isometry3d::Identity());
    const Pattern to = crestSeenFrom(onwards());
    RotationEstimate pattern;
    pattern.rotation = test::rotationAbout({0, 0, 1}, 1);
    EXPECT_EQ(paper::registerInPlace(from, to, pattern, {100, 0, 0}, {}).rotation,
              pattern.rotation);
    from.points.resize(3, 0);  // modes
    EXPECT_EQ(paper::registerInPlace(from, to, pattern, {0, 0, 0}, {}).rotation, pattern.rotation);
}

TEST(RotationInPlace, KernelsHaveToNarrow) {
    RotationInPlaceOptions options;
    options.last_kernel_deg = 5;
    EXPECT_THROW(options.check("rotation_in_place"), Error);
}
}  // namespace
