#include "odometry/motion_model.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "delio/core/geometry.h"
#include "poses.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using delio::test::degreesBetween;
using delio::test::metresBetween;
using delio::test::poseAt;
using Eigen::Isometry3d;

LinearPrediction ofFrames(unsigned frames) {
    PredictionOptions options;
    options.frames = frames;
    return LinearPrediction(options);
}

/** Translation and rotation vector. */
Isometry3d motion(const Eigen::Vector3d& t, const Eigen::Vector3d& w) {
    return delio::isometry(delio::rotationExp(w), t);
}

void expectSame(const Isometry3d& a, const Isometry3d& b, double tolerance) {
    EXPECT_LT(metresBetween(a, b), tolerance) << a.matrix() << "\nand\n" << b.matrix();
    EXPECT_LT(degreesBetween(a, b), tolerance) << a.matrix() << "\nand\n" << b.matrix();
}

TEST(Prediction, NothingKnownIsNoMotion) {
    const auto prediction = ofFrames(3);
    EXPECT_FALSE(prediction.hasMotion());
    expectSame(prediction.predict(), Isometry3d::Identity(), 1e-15);
}

TEST(Prediction, ConstantMotionGoesOn) {
    const Isometry3d step = motion({1.3, -0.1, 0.02}, {0.02, -0.3, 0.7});
    auto prediction = ofFrames(3);
    for (int i = 0; i < 6; ++i) {
        prediction.observe(step);
        EXPECT_TRUE(prediction.hasMotion());
        expectSame(prediction.predict(), step, 1e-6);
    }
}

// 2/(N(N+1)) (N-j+1) for N = 3: 3/6 of the latest, 2/6, and 1/6 of the oldest.
TEST(Prediction, TheLatestCountsMost) {
    const Eigen::Vector3d a(1, 0, 0), b(0, 1, 0), c(0, 0, 1);
    auto prediction = ofFrames(3);
    for (const auto& t : {a, b, c}) prediction.observe(motion(t, {0, 0, 0}));
    expectSame(prediction.predict(), motion(a / 6 + b / 3 + c / 2, {0, 0, 0}), 1e-12);
}

// Registration noise of a centimetre, 2 us after the scan before.
TEST(Prediction, AShortIntervalIsNoSpeed) {
    auto prediction = ofFrames(3);
    for (int i = 0; i < 2; ++i) prediction.observe(motion({1, 0, 0}, {0, 0, 0.01}), 0.1);
    prediction.observe(motion({0, 0.01, 0}, {0, 0, 0}), 2e-6);
    expectSame(prediction.predict(0.1), motion({1, 0, 0}, {0, 0, 0.01}), 0.04);
}

TEST(Prediction, RotationVectorsAreAveragedTheSameWay) {
    const Eigen::Vector3d axis(0.6, 0, 0.8);
    auto prediction = ofFrames(3);
    for (const double angle : {0.1, 0.4, -0.2}) prediction.observe(motion({0, 0, 0}, angle * axis));
    expectSame(prediction.predict(), motion({0, 0, 0}, (0.1 / 6 + 0.4 / 3 - 0.1) * axis), 1e-6);
}

TEST(Prediction, FewerThanNAreThoseThatThereAre) {
    auto prediction = ofFrames(3);
    prediction.observe(motion({6, 0, 0}, {0, 0, 0}));
    expectSame(prediction.predict(), poseAt(6, 0, 0), 1e-12);
    prediction.observe(motion({0, 3, 0}, {0, 0, 0}));
    expectSame(prediction.predict(), poseAt(2, 2, 0), 1e-12);  // 2/3 and 1/3
}

TEST(Prediction, OlderThanNIsForgotten) {
    auto prediction = ofFrames(2), one = ofFrames(1);
    for (const double x : {100.0, 3.0, 6.0}) {
        prediction.observe(poseAt(x, 0, 0));
        one.observe(poseAt(x, 0, 0));
    }
    expectSame(prediction.predict(), poseAt(5, 0, 0), 1e-12);
    expectSame(one.predict(), poseAt(6, 0, 0), 1e-12);
}

// Steps of a constant twist over unequal times, as where scans were dropped.
TEST(Prediction, ConstantSpeedGoesOnOverUnequalTimes) {
    const Eigen::Vector3d speed(13, -1, 0.2), turn(0.2, -0.3, 0.7);
    const auto over = [&](double s) {  // exp(s * twist), by many small steps
        Isometry3d pose = Isometry3d::Identity();
        for (int i = 0; i < 100000; ++i) pose = pose * motion(speed * s / 1e5, turn * s / 1e5);
        return pose;
    };
    auto prediction = ofFrames(3);
    for (const double duration : {0.1, 0.4, 0.2}) prediction.observe(over(duration), duration);
    for (const double duration : {0.1, 0.5})
        expectSame(prediction.predict(duration), over(duration), 1e-4);
}
}  // namespace
