#include "delio/slam/loop_closer.h"

#include <gtest/gtest.h>

#include "../loops/town.h"

namespace {
using namespace delio;
using namespace delio::loops_test;

/** Round the block with a sensor that lies on its side, whose pose on the vehicle is known or not;
 *  with `more`, each scan is told of once more and taken back. */
loops::ClosedLoops driven(bool isKnown, bool more = false) {
    const Eigen::Isometry3d side = test::poseAtDeg(0, 0, 0, 0, 0, 90);
    Poses truth = roundTheBlock(15);
    if (!isKnown)  // the vehicle's frame is the sensor's
        for (auto& pose : truth) pose = pose * side;
    LoopCloser closer({}, {}, {});
    test::Noise noise;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        Scan scan;
        if (isKnown) scan.sensorPose = side;
        const Eigen::Isometry3d sensor = truth[i] * scan.sensorPose,
                                level = sensor * side.inverse();
        Step step;
        step.used.points = side.linear().transpose().cast<float>() *
                           test::ringScan(town(), level, {24, 360, -24, 12, 0.01}, noise).points;
        closer.add({i, scan, step, {}, truth[i]});
        if (!more) continue;
        closer.undo();
        closer.add({i, scan, step, {}, truth[i]});
    }
    return closer.close(chainOf(truth), {});
}

TEST(LoopCloser, KnowsWhatIsUpFromTheSensorsPose) { EXPECT_GE(driven(true).accepted, 2U); }

TEST(LoopCloser, KnowsWhatIsUpFromTheSensorsAxis) { EXPECT_GE(driven(false).accepted, 2U); }

TEST(LoopCloser, UndoLeavesNoTrace) {
    const auto once = driven(true), twice = driven(true, true);
    ASSERT_EQ(once.graph.edges().size(), twice.graph.edges().size());
    for (std::size_t i = 0; i < once.graph.poses().size(); ++i)
        ASSERT_EQ(once.graph.poses()[i].matrix(), twice.graph.poses()[i].matrix()) << i;
}

TEST(LoopCloser, LeavesOutWhatMovesAndWhatWasPredicted) {
    LoopCloser closer({}, {}, {});
    Scan scan;
    Step step;
    step.used.points = Eigen::Vector3f(5, 0, 0).replicate(1, 3);
    step.used.points(0, 1) = 8;
    step.used.dynamic = {1, 0, 1};
    closer.add({0, scan, step, {}, test::poseAt(0, 0, 0)});
    step.used.points(0, 1) = 11;
    step.predicted = true;
    closer.add({1, scan, step, {}, test::poseAt(0, 0, 0)});
    closer.close(chainOf({test::poseAt(0, 0, 0), test::poseAt(0, 0, 0)}), {});
    ASSERT_EQ(closer.submaps().size(), 1U);
    ASSERT_EQ(closer.submaps()[0].points.cols(), 1);
    EXPECT_EQ(closer.submaps()[0].points(0, 0), 8);
}
}  // namespace
