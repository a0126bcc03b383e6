#include <gtest/gtest.h>

#include <functional>
#include <tuple>

#include "odometry_drive.h"

// Scans that a sensor may give and that a drive cannot be made of: each is registered right, or
// said to be predicted, and the drive goes on right after it. (bad_scan_test.cpp has the empty
// ones.)
namespace {
using namespace delio;
using namespace delio::odometry_test;
using Eigen::Isometry3d;

Scan fiftyPoints(const Isometry3d&) {
    test::Noise noise;
    Eigen::Matrix3Xf points(3, 50);
    for (int i = 0; i < 50; ++i) points.col(i) = (10 * noise.direction()).cast<float>();
    return test::scanOf(points);
}

Scan oneRing(const Isometry3d& pose) {
    test::Noise noise;
    const test::Sensor sensor{1, 1800, 0, 0, 0.01, {-3}};
    return test::scanOf(test::ringScan(test::yard(), pose, sensor, noise).points);
}

/** All that is seen is the inside of a block about the sensor, which moves along. */
Scan inside(const Eigen::Vector3d& half) {
    test::Noise noise;
    const auto here = Isometry3d::Identity();
    return test::scanOf(
        test::ringScan({{-half, half}}, here, {28, 400, -24, 8, 0.003}, noise).points);
}

Scan ownBody(const Isometry3d&) { return inside({1.2, 0.6, 0.4}); }
Scan boxOfAMetre(const Isometry3d&) { return inside({0.5, 0.5, 0.5}); }

Scan allAt(const Eigen::Vector3f& place) { return test::scanOf(place.replicate(1, 20000)); }
Scan intensitiesOnly(const Isometry3d&) { return allAt(Eigen::Vector3f::Zero()); }
Scan onePlace(const Isometry3d&) { return allAt({7, 2, 0.5}); }

Scan halfNaN(const Isometry3d& pose) {
    Scan scan = scanAt(pose, 40);
    for (std::size_t i = 0; i < scan.points->size(); i += 2)
        scan.points->setPointFast(i, std::numeric_limits<float>::quiet_NaN(), 1, 1);
    return scan;
}

Scan aMillionPoints(const Isometry3d& pose) {
    test::Noise noise;
    return test::scanOf(
        test::ringScan(test::yard(), pose, {64, 17000, -24, 8, 0.01}, noise).points);
}

struct Kind {
    const char* name;
    std::function<Scan(const Isometry3d& pose)> scan;
    bool canBeUsed;
    double degrees = 2 * kDegrees;  //!< it may be off, where it is used
};

const std::vector<Kind> kKinds = {
    {"FiftyPoints", fiftyPoints, false},
    {"OneRing", oneRing, true, 1},
    {"OwnBody", ownBody, false},
    {"BoxOfAMetre", boxOfAMetre, false},
    {"IntensitiesOnly", intensitiesOnly, false},
    {"OnePlace", onePlace, false},
    {"HalfNaN", halfNaN, true},
    {"AMillionPoints", aMillionPoints, true},
};

class BadInput : public testing::TestWithParam<std::tuple<std::string, Kind>> {
 protected:
    static std::string profile() { return std::get<0>(GetParam()); }
    static Kind kind() { return std::get<1>(GetParam()); }
};

std::string nameOf(const testing::TestParamInfo<std::tuple<std::string, Kind>>& values) {
    return (std::get<0>(values.param) == "paper" ? "Paper" : "Planes") +
           std::string(std::get<1>(values.param).name);
}

INSTANTIATE_TEST_SUITE_P(Odometry, BadInput,
                         testing::Combine(testing::Values("accurate"), testing::ValuesIn(kKinds)),
                         nameOf);
// The paper's normals of a million points take their time.
INSTANTIATE_TEST_SUITE_P(PaperOdometry, BadInput,
                         testing::Combine(testing::Values("paper"),
                                          testing::ValuesIn(kKinds.begin(), kKinds.end() - 1)),
                         nameOf);

void expectRightOrPredicted(const Step& step, const Isometry3d& truth,
                            double degrees = 2 * kDegrees) {
    expectCovariance(step.increment);
    EXPECT_EQ(step.reason.empty(), !step.predicted);
    if (!step.predicted) expectPose(step.increment.pose, truth, 2 * kMetres, degrees);
}

TEST_P(BadInput, InTheMidstOfADrive) {
    const auto truth = drive(8);
    auto scans = scansOf(truth);
    scans[4] = kind().scan(truth[4]);
    const auto steps = stepsOf(scans, quick(profile()));
    if (!kind().canBeUsed) {
        EXPECT_TRUE(steps[4].predicted);
    }
    expectRightOrPredicted(steps[4], stepTo(truth, 4), kind().degrees);
    // The drive is steady: the prediction is right within centimetres.
    expectPose(steps[4].increment.pose, stepTo(truth, 4), 0.1, 1);
    Isometry3d pose = truth[0];
    for (const auto& step : steps) pose = pose * step.increment.pose;
    expectPose(pose, truth[7], 4 * kMetres, 4 * kDegrees);
    for (const std::size_t i : {1, 2, 3, 6, 7}) EXPECT_FALSE(steps[i].predicted) << i;
}

TEST_P(BadInput, AsTheFirstScan) {
    const auto truth = drive(10);
    auto scans = scansOf(truth);
    scans[0] = kind().scan(truth[0]);
    const auto steps = stepsOf(scans, quick(profile()));
    expectNoMotion(steps[0].increment.pose);
    for (std::size_t i = 1; i < steps.size(); ++i) {
        SCOPED_TRACE(i);
        expectRightOrPredicted(steps[i], stepTo(truth, i));
    }
    for (std::size_t i = 6; i < steps.size(); ++i)
        EXPECT_FALSE(steps[i].predicted) << i << " " << steps[i].reason;
}

TEST_P(BadInput, AndNothingElse) {
    if (kind().canBeUsed) return;
    const auto here = Isometry3d::Identity();
    const auto steps =
        stepsOf({kind().scan(here), kind().scan(here), kind().scan(here)}, quick(profile()));
    for (const auto& step : steps) {
        expectPose(step.increment.pose, here, kMetres, kDegrees);
        expectCovariance(step.increment);
        EXPECT_EQ(step.reason.empty(), !step.predicted);
    }
}
}  // namespace
