#include "slam/place_listeners.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <tbb/global_control.h>

#include <functional>
#include <system_error>
#include <thread>

#include "../places/town.h"
#include "delio/core/error.h"

namespace {
using namespace delio;
using namespace delio::places_test;

/** Round the block with a sensor that lies on its side, whose pose on the vehicle is known or not;
 * `change`: of each step. */
places::ClosedLoops driven(bool isKnown, const std::function<void(Step&)>& change = {}) {
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
        if (change) change(step);
        Increment increment{Eigen::Isometry3d::Identity(), 1e-6 * Matrix6::Identity()};
        if (i > 0) increment.pose = truth[i - 1].inverse() * truth[i];
        closer.add({i, scan, step, increment, truth[i]});
    }
    return closer.close(chainOf(truth), {});
}

TEST(LoopCloser, KnowsWhatIsUpFromTheSensorsPose) { EXPECT_GE(driven(true).accepted, 2U); }

TEST(LoopCloser, KnowsWhatIsUpFromTheSensorsAxis) { EXPECT_GE(driven(false).accepted, 2U); }

TEST(LoopCloser, FindsTheSameBesideTheDriveAndInIt) {
    const auto beside = driven(true);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const auto within = driven(true);
    ASSERT_EQ(beside.candidates.size(), within.candidates.size());
    for (std::size_t i = 0; i < beside.graph.poses().size(); ++i)
        ASSERT_EQ(beside.graph.poses()[i].matrix(), within.graph.poses()[i].matrix()) << i;
}

/** While it lives, no thread can be started: its stack would be larger than any memory. */
class NoMoreThreads {
 public:
    NoMoreThreads() {
        pthread_attr_t none;
        pthread_getattr_default_np(&before_);
        pthread_attr_init(&none);
        pthread_attr_setstacksize(&none, std::size_t{1} << 46);
        pthread_setattr_default_np(&none);
        pthread_attr_destroy(&none);
    }
    ~NoMoreThreads() {
        pthread_setattr_default_np(&before_);
        pthread_attr_destroy(&before_);
    }
    NoMoreThreads(const NoMoreThreads&) = delete;
    NoMoreThreads& operator=(const NoMoreThreads&) = delete;

 private:
    pthread_attr_t before_{};
};

TEST(LoopCloser, FindsTheSameWhereTheSystemHasNoMoreThreads) {
    const tbb::global_control two(tbb::global_control::max_allowed_parallelism, 2);
    const auto beside = driven(true);
    const NoMoreThreads none;
    EXPECT_THROW(std::thread([] {}).join(), std::system_error);
    const auto within = driven(true);
    EXPECT_GE(beside.accepted, 2U);
    ASSERT_EQ(beside.candidates.size(), within.candidates.size());
    for (std::size_t i = 0; i < beside.graph.poses().size(); ++i)
        ASSERT_EQ(beside.graph.poses()[i].matrix(), within.graph.poses()[i].matrix()) << i;
}

TEST(LoopCloser, LeavesOutWhatMovesAndWhatWasPredicted) {
    const auto moving = [](Step& step) {
        step.used.dynamic.assign(static_cast<std::size_t>(step.used.points.cols()), 1);
    };
    EXPECT_EQ(driven(true, moving).accepted, 0U);
    EXPECT_EQ(driven(true, [](Step& step) { step.predicted = true; }).accepted, 0U);
}

TEST(LoopCloser, SaysWhereItCannotPutSubmapsAside) {
    LoopCloser closer({}, {}, {}, "/no/such/folder");
    closer.add({0, {}, {}, {}, test::poseAt(0, 0, 0)});
    try {
        closer.close(chainOf({test::poseAt(0, 0, 0)}), {});
        FAIL() << "nothing was thrown";
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("/no/such/folder"), std::string::npos) << e.what();
    }
}
}  // namespace
