// Scans in, rotation out: what the paper claims of the pattern, on scans of a yard.
#include <gtest/gtest.h>

#include "delio/slam/options.h"
#include "paper/normals.h"
#include "paper/outlier_removal.h"
#include "paper/pattern_registration.h"
#include "ring_scan.h"

namespace {
using namespace delio;
using test::poseAt;
using test::rotationAbout;

constexpr double kDegree = M_PI / 180;

paper::Pattern patternSeenFrom(const Eigen::Isometry3d& pose, const PaperOdometryOptions& options,
                               test::Noise& noise) {
    const test::Sensor sensor{64, 1440, -24, 4, 0.02};
    const auto points = test::ringScan(test::yard(), pose, sensor, noise).points;
    const auto normals = paper::surfacesOf(points, options.normals, options.bilateral);
    return paper::removeOutliers(normals, options.outliers);
}

TEST(RotationStage, IsBlindToTranslation) {
    test::Noise noise;
    const auto options = Options::ofProfile("paper").paper;
    const auto from = patternSeenFrom(Eigen::Isometry3d::Identity(), options, noise);
    const auto to = patternSeenFrom(poseAt(3, 0, 0), options, noise);
    const Eigen::Matrix3d truth = Eigen::Matrix3d::Identity();
    for (int i = 0; i < 20; ++i) {
        const Eigen::Matrix3d start = rotationAbout({1, 0, 0}, 3 * noise.uniform()) *
                                      rotationAbout({0, 1, 0}, 3 * noise.uniform()) *
                                      rotationAbout({0, 0, 1}, 3 * noise.uniform());
        const auto found = paper::registerPatterns(from, to, start, options.pattern);
        EXPECT_TRUE(found.valid);
        EXPECT_LT(test::degreesBetween(found.rotation, truth), 0.1) << "start " << i;
    }
}

TEST(RotationStage, TenDegreesFromNoPrediction) {
    test::Noise noise;
    const auto options = Options::ofProfile("paper").paper;
    const auto from = patternSeenFrom(Eigen::Isometry3d::Identity(), options, noise);
    for (const double yaw : {-10.0, 10.0}) {
        const auto to = patternSeenFrom(poseAt(1, 0.2, 0, yaw * kDegree), options, noise);
        const auto found =
            paper::registerPatterns(from, to, Eigen::Matrix3d::Identity(), options.pattern);
        EXPECT_LT(test::degreesBetween(found.rotation, rotationAbout({0, 0, 1}, yaw)), 0.2) << yaw;
    }
}
}  // namespace
