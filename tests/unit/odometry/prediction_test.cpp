#include "delio/odometry/prediction.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "ring_scan.h"

namespace {
using delio::LinearPrediction;
using delio::PredictionOptions;
using delio::test::degreesBetween;
using mrpt::poses::CPose3D;

LinearPrediction ofFrames(unsigned frames) {
    PredictionOptions options;
    options.frames = frames;
    return LinearPrediction(options);
}

/** Translation and rotation vector. */
CPose3D motion(const Eigen::Vector3d& t, const Eigen::Vector3d& w) {
    const double angle = w.norm();
    const Eigen::Matrix3d R =
        Eigen::AngleAxisd(angle, angle > 0 ? Eigen::Vector3d(w / angle) : Eigen::Vector3d(1, 0, 0))
            .toRotationMatrix();
    CPose3D pose(t.x(), t.y(), t.z());
    pose.setRotationMatrix(mrpt::math::CMatrixDouble33(R));
    return pose;
}

void expectSame(const CPose3D& a, const CPose3D& b, double tolerance) {
    EXPECT_LT(a.distanceTo(b), tolerance) << a << " and " << b;
    EXPECT_LT(degreesBetween(a, b), tolerance) << a << " and " << b;
}

TEST(Prediction, NothingKnownIsNoMotion) {
    const auto prediction = ofFrames(3);
    EXPECT_FALSE(prediction.hasMotion());
    expectSame(prediction.predict(), {}, 1e-15);
}

TEST(Prediction, ConstantMotionGoesOn) {
    const CPose3D step = motion({1.3, -0.1, 0.02}, {0.02, -0.3, 0.7});
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

TEST(Prediction, RotationVectorsAreAveragedTheSameWay) {
    const Eigen::Vector3d axis(0.6, 0, 0.8);
    auto prediction = ofFrames(3);
    for (const double angle : {0.1, 0.4, -0.2}) prediction.observe(motion({0, 0, 0}, angle * axis));
    expectSame(prediction.predict(), motion({0, 0, 0}, (0.1 / 6 + 0.4 / 3 - 0.1) * axis), 1e-6);
}

TEST(Prediction, FewerThanNAreThoseThatThereAre) {
    auto prediction = ofFrames(3);
    prediction.observe(motion({6, 0, 0}, {0, 0, 0}));
    expectSame(prediction.predict(), CPose3D(6, 0, 0), 1e-12);
    prediction.observe(motion({0, 3, 0}, {0, 0, 0}));
    expectSame(prediction.predict(), CPose3D(2, 2, 0), 1e-12);  // 2/3 and 1/3
}

TEST(Prediction, OlderThanNIsForgotten) {
    auto prediction = ofFrames(2), one = ofFrames(1);
    for (const double x : {100.0, 3.0, 6.0}) {
        prediction.observe(CPose3D(x, 0, 0));
        one.observe(CPose3D(x, 0, 0));
    }
    expectSame(prediction.predict(), CPose3D(5, 0, 0), 1e-12);
    expectSame(one.predict(), CPose3D(6, 0, 0), 1e-12);
}
// Steps of a constant twist over unequal times, as where scans were dropped.
TEST(Prediction, ConstantSpeedGoesOnOverUnequalTimes) {
    const Eigen::Vector3d speed(13, -1, 0.2), turn(0.2, -0.3, 0.7);
    const auto over = [&](double s) {  // exp(s * twist), by many small steps
        CPose3D pose;
        for (int i = 0; i < 100000; ++i) pose = pose + motion(speed * s / 1e5, turn * s / 1e5);
        return pose;
    };
    auto prediction = ofFrames(3);
    for (const double duration : {0.1, 0.4, 0.2}) prediction.observe(over(duration), duration);
    for (const double duration : {0.1, 0.5})
        expectSame(prediction.predict(duration), over(duration), 1e-4);
}
}  // namespace
