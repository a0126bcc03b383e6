#include "odometry_drive.h"

// PlaneOdometry takes the lengths of its map from the size of the place.
namespace {
using namespace delio;
using namespace delio::odometry_test;

/** A hut of 5 m by 5 m about the origin, in the yard, with a door of a metre towards x. */
test::Scene hutInTheYard() {
    auto scene = test::yard();
    const test::Scene hut = {
        {{-2.7, -2.7, -2}, {-2.5, 2.7, 1}}, {{-2.7, -2.7, -2}, {2.7, -2.5, 1}},
        {{-2.7, 2.5, -2}, {2.7, 2.7, 1}},   {{2.5, -2.7, -2}, {2.7, -0.5, 1}},
        {{2.5, 0.5, -2}, {2.7, 2.7, 1}},    {{-2.7, -2.7, 0.9}, {2.7, 2.7, 1}}};
    scene.insert(scene.end(), hut.begin(), hut.end());
    return scene;
}

TEST(Rescaling, OutOfAHutIntoTheYard) {
    Poses truth{poseAtDeg(-1.5, 0.2, 0, 2)};
    while (truth.size() < 45) truth.push_back(truth.back() * poseAtDeg(0.25, 0, 0, 0.1));
    const auto steps = stepsOf(scansOf(truth, hutInTheYard()), quick("accurate"));
    EXPECT_LT(valueOf(steps[0].details, "scale"), 0.5);
    for (std::size_t i = 1; i < steps.size(); ++i) {
        SCOPED_TRACE(i);
        EXPECT_FALSE(steps[i].predicted) << steps[i].reason;
        // A map that has just begun may leave an axis open; then that is said.
        const auto& weak = steps[i].quality.unobservedTranslation;
        const auto& before = steps[i - 1].quality.unobservedTranslation;
        const bool isWeak = weak.cols() > 0 || before.cols() > 0;
        expectPose(steps[i].increment.pose, stepTo(truth, i), isWeak ? 0.25 : kMetres, kDegrees);
        // Once it is larger it stays so.
        EXPECT_GE(valueOf(steps[i].details, "scale"), valueOf(steps[i - 1].details, "scale"));
    }
    EXPECT_GT(valueOf(steps.back().details, "scale"), 0.8);
    Eigen::Isometry3d pose = truth[0];
    for (const auto& step : steps) pose = pose * step.increment.pose;
    expectPose(pose, truth.back(), 0.1, 1);
}
}  // namespace
