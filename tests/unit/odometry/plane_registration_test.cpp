#include "odometry/register_planes.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "core/voxel_grid.h"
#include "odometry/initial_guess.h"
#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using odometry::Correspondences;
using odometry::PlaneMap;
using test::degreesBetween;
using test::metresBetween;
using test::poseAt;
using test::rotationAbout;

/** Points on random planes, seen from pose (R, t), with their true planes. */
Correspondences matchesSeenFrom(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, double noise_m,
                                test::Noise& noise) {
    Correspondences matches(300);
    for (auto& match : matches) {
        match.normal = noise.direction();
        match.mean = 10 * noise.normals();
        const Eigen::Vector3d aside = noise.normals();
        const Eigen::Vector3d onPlane = match.mean + aside - aside.dot(match.normal) * match.normal;
        match.point = R.transpose() * (onPlane + noise_m * noise.normals() - t);
        match.weight = 1 + 0.5 * noise.uniform();
    }
    return matches;
}

/** The motion model's. */
odometry::Prior priorAt(const Eigen::Isometry3d& pose) {
    return odometry::priorOf(pose, PlaneRegistrationOptions{});
}

// What decoupling means here: whatever the translation is, it does not move the rotation.
TEST(PlaneRotation, DoesNotDependOnTheTranslation) {
    test::Noise noise;
    const Eigen::Matrix3d truth = rotationAbout({1, 2, 3}, 20);
    const auto matches = matchesSeenFrom(truth, {3, -2, 1}, 0.01, noise);
    const Eigen::Matrix3d R = truth * rotationAbout({0, 1, 1}, 0.5);
    const auto here = odometry::rotationFromPlanes(matches, isometry(R, {3, -2, 1}));
    const auto there = odometry::rotationFromPlanes(matches, isometry(R, {-50, 70, 20}));
    EXPECT_LT((here.step - there.step).norm(), 1e-9);
    EXPECT_GT(here.step.norm(), 0.008);
    EXPECT_TRUE(here.information.isApprox(there.information));
}

TEST(PlaneRotation, ConvergesToThePlantedRotationFromTenDegrees) {
    test::Noise noise;
    const Eigen::Matrix3d truth = rotationAbout({1, -2, 0.5}, 30);
    const auto matches = matchesSeenFrom(truth, {5, 6, 7}, 0, noise);
    Eigen::Matrix3d R = truth * rotationAbout({1, 1, -1}, 10);
    for (int i = 0; i < 10; ++i) {
        const Eigen::Vector3d w =
            odometry::rotationFromPlanes(matches, isometry(R, {0, 0, 0})).step;
        if (w.norm() > 0) R = R * Eigen::AngleAxisd(w.norm(), w.normalized()).matrix();
    }
    EXPECT_LT(degreesBetween(R, truth), 1e-6);
}

TEST(PlaneTranslation, ItsStepAloneIsTheSame) {
    test::Noise noise;
    const auto matches = matchesSeenFrom(rotationAbout({1, 2, 3}, 20), {3, -2, 1}, 0.01, noise);
    const auto pose = poseAt(1, 2, 3, 0.1);
    const auto all = odometry::translationFromPlanes(matches, pose, priorAt(pose));
    EXPECT_EQ(all.step, odometry::stepFromPlanes(matches, pose, priorAt(pose)));
    EXPECT_GT(all.step.norm(), 0.1);
    EXPECT_TRUE(all.information.isApprox(all.information.transpose()));
}

/** Half the weighted squares of the residuals, with the best translation for each rotation. */
double reducedCost(const Correspondences& matches, const Eigen::Matrix3d& R) {
    const auto move = odometry::translationFromPlanes(matches, isometry(R, {0, 0, 0}));
    double cost = 0;
    for (const auto& match : matches)
        cost += match.weight * std::pow(match.residual(R, move.step), 2) / 2;
    return cost;
}

TEST(PlaneRotation, InformationIsTheCurvatureOfTheCostWithoutTranslation) {
    test::Noise noise;
    const Eigen::Matrix3d truth = rotationAbout({0, 0, 1}, 40);
    const auto matches = matchesSeenFrom(truth, {1, 2, 3}, 0, noise);
    const auto found = odometry::rotationFromPlanes(matches, isometry(truth, {1, 2, 3}));
    constexpr double h = 1e-4;
    for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d axis = Eigen::Vector3d::Unit(k);
        const double degrees = h * 180 / M_PI;
        const double up = reducedCost(matches, truth * rotationAbout(axis, degrees)),
                     down = reducedCost(matches, truth * rotationAbout(axis, -degrees)),
                     here = reducedCost(matches, truth);
        EXPECT_NEAR((up - 2 * here + down) / (h * h) / found.information(k, k), 1, 1e-4);
    }
}

TEST(PlaneTranslation, IsTheLeastSquaresSolution) {
    test::Noise noise;
    const Eigen::Matrix3d R = rotationAbout({1, 0, 2}, 15);
    const Eigen::Vector3d truth(3, -1, 0.5);
    const auto exact = matchesSeenFrom(R, truth, 0, noise);
    EXPECT_LT((odometry::translationFromPlanes(exact, isometry(R, {0, 0, 0})).step - truth).norm(),
              1e-9);
    const auto noisy = matchesSeenFrom(R, truth, 0.05, noise);
    const auto cost = [&](const Eigen::Vector3d& t) {
        double sum = 0;
        for (const auto& match : noisy) sum += match.weight * std::pow(match.residual(R, t), 2);
        return sum;
    };
    const Eigen::Vector3d best =
        odometry::translationFromPlanes(noisy, isometry(R, {0, 0, 0})).step;
    for (int i = 0; i < 50; ++i) EXPECT_GT(cost(best + 1e-3 * noise.direction()), cost(best));
}

TEST(PlaneTranslation, AnAxisThatNoNormalSeesIsLeftAlone) {
    test::Noise noise;
    auto matches = matchesSeenFrom(Eigen::Matrix3d::Identity(), {1, 1, 1}, 0, noise);
    for (auto& match : matches) {
        match.normal.x() = 0;
        match.normal.normalize();
        match.point = match.mean - Eigen::Vector3d(1, 1, 1);
    }
    const auto found = odometry::translationFromPlanes(matches, Eigen::Isometry3d::Identity());
    EXPECT_LT((found.step - Eigen::Vector3d(0, 1, 1)).norm(), 1e-9);
}

// Information adds: of a pose that is known as well as the planes know it, half is kept.
TEST(PlanePrior, IsFusedByItsInformation) {
    test::Noise noise;
    const Eigen::Vector3d truth(1, 2, 3);
    const auto matches = matchesSeenFrom(Eigen::Matrix3d::Identity(), truth, 0, noise);
    const auto alone = odometry::translationFromPlanes(matches, Eigen::Isometry3d::Identity());
    odometry::Prior prior;  // at the origin
    prior.translation = alone.information.trace() / 3;
    const auto fused =
        odometry::translationFromPlanes(matches, Eigen::Isometry3d::Identity(), prior);
    const Eigen::Vector3d expected =
        (alone.information + prior.translation * Eigen::Matrix3d::Identity())
            .ldlt()
            .solve(alone.information * truth);
    EXPECT_LT((fused.step - expected).norm(), 1e-9);
    EXPECT_LT((fused.step - truth / 2).norm(), 0.2);
    EXPECT_TRUE(fused.information.isApprox(alone.information));
}

TEST(PlanePrior, HoldsARotationThatNoPlaneSees) {
    test::Noise noise;
    auto matches = matchesSeenFrom(Eigen::Matrix3d::Identity(), {0, 0, 0}, 0, noise);
    for (auto& match : matches) match.normal = Eigen::Vector3d::UnitZ();  // yaw is not seen
    odometry::Prior prior;
    prior.rotation = 1e-3 * Eigen::Matrix3d::Identity();
    const auto turned = isometry(rotationAbout({0, 0, 1}, 2), {0, 0, 0});
    EXPECT_LT(odometry::rotationFromPlanes(matches, turned).step.z(), 1e-9);
    EXPECT_NEAR(odometry::rotationFromPlanes(matches, turned, prior).step.z(), -2 * M_PI / 180,
                1e-6);
}

// Normals that are known badly see axes that they do not look along.
TEST(PlaneTranslation, SaysWhatUncertainNormalsPretend) {
    test::Noise noise;
    auto matches = matchesSeenFrom(Eigen::Matrix3d::Identity(), {0, 0, 0}, 0, noise);
    double weight = 0;
    for (auto& match : matches) {
        match.normal = Eigen::Vector3d::UnitZ();
        match.tilt = 0.01;
        weight += match.weight;
    }
    const auto found = odometry::translationFromPlanes(matches, Eigen::Isometry3d::Identity());
    EXPECT_NEAR(found.pretended(0, 0), 0.01 * weight, 1e-9);
    EXPECT_NEAR(found.pretended(2, 2), 0, 1e-9);
    EXPECT_NEAR(found.information(2, 2), weight, 1e-9);
}

const test::Sensor kSensor{64, 1440, -24, 4, 0.01};

Eigen::Matrix3Xf pointsSeenFrom(const test::Scene& scene, const Eigen::Isometry3d& pose,
                                test::Noise& noise) {
    return test::ringScan(scene, pose, kSensor, noise).points;
}

/** The scene as one scan from the origin sees it. */
PlaneMap mapOf(const test::Scene& scene, test::Noise& noise) {
    PlaneMap map(PlaneMapOptions{});
    map.add(voxelCentroids(pointsSeenFrom(scene, Eigen::Isometry3d::Identity(), noise), 0.25)
                .cast<double>());
    return map;
}

TEST(Matcher, FindsTheSameAsOneThatKnowsNoEarlierPose) {
    test::Noise noise;
    const PlaneMap map = mapOf(test::yard(), noise);
    const Eigen::Matrix3Xd points =
        voxelCentroids(pointsSeenFrom(test::yard(), Eigen::Isometry3d::Identity(), noise), 0.5)
            .cast<double>();
    constexpr double kKernel = 0.2, kPointSigma = 0.02;
    odometry::Matcher matcher(map, points, kPointSigma);
    for (const double x : {0.0, 0.001, 0.05, 1.0, 0.3, 0.0}) {
        const Eigen::Isometry3d pose = poseAt(x, -x / 2, 0, x / 10, 0, 0);
        odometry::Matcher anew(map, points, kPointSigma);
        const auto found = matcher.at(pose, kKernel), wanted = anew.at(pose, kKernel);
        ASSERT_EQ(found.size(), wanted.size());
        EXPECT_GT(found.size(), 100U);
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_EQ(found[i].point, wanted[i].point);
            EXPECT_EQ(found[i].mean, wanted[i].mean);
            EXPECT_EQ(found[i].weight, wanted[i].weight);
        }
        EXPECT_EQ(matcher.shareAt(pose, kKernel), anew.shareAt(pose, kKernel));
        double cost = 0;
        for (const auto& match : wanted) {
            const double r = match.residual(pose.linear(), pose.translation());
            cost += match.weight * r * r;
        }
        const auto sum = matcher.sumAt<double>(
            [&](std::size_t i) -> Eigen::Vector3d {
                return pose * points.col(static_cast<Eigen::Index>(i));
            },
            kKernel,
            [](std::size_t, const Eigen::Vector3d& at, const odometry::Plane& plane, double weight,
               double& all) { all += weight * std::pow(plane.normal().dot(at - plane.mean), 2); });
        EXPECT_NEAR(sum, cost, 1e-9 * cost);
    }
}

TEST(PlaneRegistration, FindsAScanInTheMap) {
    test::Noise noise;
    const PlaneMap map = mapOf(test::yard(), noise);
    const Eigen::Isometry3d truth = poseAt(0.8, 0.1, 0.02, 0.03, 0.004, -0.003);
    const Eigen::Matrix3Xd points =
        voxelCentroids(pointsSeenFrom(test::yard(), truth, noise), 0.5).cast<double>();
    const auto found = odometry::registerToPlanes(
        map, points, priorAt(isometry(rotationAbout({0, 0, 1}, 0.5), {0.5, 0, 0})), 1,
        PlaneRegistrationOptions{});
    ASSERT_TRUE(found.valid);
    EXPECT_LT(degreesBetween(found.rotation.rotation, truth.linear()), 0.05);
    EXPECT_LT((found.translation.translation - Eigen::Vector3d(0.8, 0.1, 0.02)).norm(), 0.01);
    EXPECT_GT(found.inlierRatio, 0.9);
    EXPECT_EQ(found.rotation.unobservedAxes.cols() + found.translation.unobservedAxes.cols(), 0);
    EXPECT_EQ(found.rotation.covariance.llt().info(), Eigen::Success);
    EXPECT_EQ(found.translation.covariance.llt().info(), Eigen::Success);
}

TEST(PlaneRegistration, TheSearchFindsWhatTheIterationCannot) {
    test::Noise noise;
    const PlaneMap map = mapOf(test::yard(), noise);
    const Eigen::Isometry3d truth = poseAt(3.2, -0.9, 0);
    const Eigen::Matrix3Xf scan = pointsSeenFrom(test::yard(), truth, noise);
    const Eigen::Matrix3Xd points = voxelCentroids(scan, 0.5).cast<double>();
    const auto surfaces = paper::estimateNormals(scan, NormalsOptions{});
    const auto found = odometry::searchInPlanes(
        map, points, surfaces, Eigen::Isometry3d::Identity(), 4, PlaneRegistrationOptions{});
    ASSERT_TRUE(found.valid);
    EXPECT_LT((found.translation.translation - Eigen::Vector3d(3.2, -0.9, 0)).norm(), 0.02);
    const auto agreed = [&](const Eigen::Vector3d& t) {
        return odometry::agreement(map, surfaces, isometry(Eigen::Matrix3d::Identity(), t), 0.2);
    };
    EXPECT_GT(agreed({3.2, -0.9, 0}), 1.5 * agreed({0, 0, 0}));
    EXPECT_LE(agreed({3.2, -0.9, 0}), 1);
}

TEST(PlaneRegistration, AlongACorridorThePredictionStays) {
    test::Noise noise;
    const PlaneMap map = mapOf(test::corridor(), noise);
    const Eigen::Matrix3Xd points =
        voxelCentroids(pointsSeenFrom(test::corridor(), poseAt(1, 0.2, 0.05), noise), 0.5)
            .cast<double>();
    const auto found = odometry::registerToPlanes(map, points, priorAt(poseAt(0.6, 0, 0)), 1,
                                                  PlaneRegistrationOptions{});
    ASSERT_TRUE(found.valid);
    ASSERT_EQ(found.translation.unobservedAxes.cols(), 1);
    EXPECT_NEAR(std::abs(found.translation.unobservedAxes(0, 0)), 1, 1e-2);
    EXPECT_NEAR(found.translation.translation.x(), 0.6, 0.02);
    EXPECT_NEAR(found.translation.translation.y(), 0.2, 0.01);
    EXPECT_GT(found.translation.covariance(0, 0), 0.2);
    EXPECT_EQ(found.rotation.unobservedAxes.cols(), 0);
}

TEST(PlaneRegistration, FromAnotherStartItLeadsToTheSamePose) {
    test::Noise noise;
    const PlaneMap map = mapOf(test::corridor(), noise);
    const Eigen::Matrix3Xd points =
        voxelCentroids(pointsSeenFrom(test::corridor(), poseAt(1, 0.2, 0.05), noise), 0.5)
            .cast<double>();
    const auto prior = priorAt(poseAt(0.6, 0, 0));
    const PlaneRegistrationOptions options;
    const auto fromPrior = odometry::registerToPlanes(map, points, prior, 1, options);
    for (const double x : {0.5, 0.8}) {
        const auto found = odometry::registerToPlanes(map, points, prior, poseAt(x, 0.15, 0.03),
                                                      options.last_kernel, options);
        ASSERT_TRUE(found.valid) << x;
        EXPECT_LT(metresBetween(found.pose(), fromPrior.pose()), 2e-3) << x;
        EXPECT_LT(found.rotation.iterations, fromPrior.rotation.iterations) << x;
    }
}

TEST(PlaneRegistration, WithoutPlanesThePredictionStays) {
    test::Noise noise;
    const PlaneMap empty(PlaneMapOptions{});
    const Eigen::Matrix3Xd points =
        pointsSeenFrom(test::yard(), Eigen::Isometry3d::Identity(), noise).cast<double>();
    const Eigen::Matrix3d R = rotationAbout({0, 0, 1}, 3);
    for (const auto& cloud : {points, Eigen::Matrix3Xd(3, 0)}) {
        const auto found = odometry::registerToPlanes(empty, cloud, priorAt(isometry(R, {1, 2, 3})),
                                                      1, PlaneRegistrationOptions{});
        EXPECT_FALSE(found.valid);
        EXPECT_EQ(found.rotation.rotation, R);
        EXPECT_EQ(found.translation.translation, Eigen::Vector3d(1, 2, 3));
        EXPECT_EQ(found.rotation.covariance.llt().info(), Eigen::Success);
        EXPECT_EQ(found.translation.covariance.llt().info(), Eigen::Success);
    }
}
}  // namespace
