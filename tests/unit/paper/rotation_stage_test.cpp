// Scans in, rotation out: what the paper claims of the pattern, on scans of a yard.
#include <gtest/gtest.h>

#include "delio/odometry/odometry.h"
#include "delio/slam/options.h"
#include "ring_scan.h"

namespace {
using namespace delio;
using mrpt::poses::CPose3D;
using test::rotationAbout;

constexpr double kDegree = M_PI / 180;

paper::Pattern patternSeenFrom(const CPose3D& pose, const OdometryOptions& options,
                                  test::Noise& noise) {
    const test::Sensor sensor{64, 1440, -24, 4, 0.02};
    const auto normals = surfaces::filterBilaterally(
        surfaces::estimateNormals(test::ringScan(test::yard(), pose, sensor, noise).points,
                                  options.normals),
        options.bilateral);
    return paper::removeOutliers(normals, options.outliers);
}

TEST(RotationStage, IsBlindToTranslation) {
    test::Noise noise;
    const auto options = Options::ofProfile("paper").odometry;
    const auto from = patternSeenFrom({}, options, noise);
    const auto to = patternSeenFrom({3, 0, 0, 0, 0, 0}, options, noise);
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
    const auto options = Options::ofProfile("paper").odometry;
    const auto from = patternSeenFrom({}, options, noise);
    for (const double yaw : {-10.0, 10.0}) {
        const auto to = patternSeenFrom({1, 0.2, 0, yaw * kDegree, 0, 0}, options, noise);
        const auto found =
            paper::registerPatterns(from, to, Eigen::Matrix3d::Identity(), options.pattern);
        EXPECT_LT(test::degreesBetween(found.rotation, rotationAbout({0, 0, 1}, yaw)), 0.2) << yaw;
    }
}
}  // namespace
