#include "back.h"

#include <gtest/gtest.h>

#include "drive.h"
#include "scene_support.h"

namespace {
using namespace delio;
using namespace delio::synth;

TEST(SynthBack, TheOtherWayInTheOtherLane) {
    constexpr std::size_t kScans = 60;
    const auto scene = test::sceneOf("urban", 3, kScans);
    const Drive there(scene->road(), kScans, 3);
    Drive back(scene->road(), kScans, 3);
    back.turnBack();
    ASSERT_EQ(back.scans(), there.scans());
    const double apart = -2 * scene->road().vehicleSide();
    ASSERT_GT(apart, 2);
    for (std::size_t i = 0; i < kScans; ++i) {
        const Eigen::Isometry3d went = there.lidarPose(kScans - 1 - i), comes = back.lidarPose(i);
        const Eigen::Vector3d beside = went.inverse() * comes.translation();
        EXPECT_NEAR(beside.x(), 0, 0.05) << i;
        EXPECT_NEAR(beside.y(), apart, 0.1) << i;  // the road is higher in its middle
        EXPECT_LT(went.linear().col(0).dot(comes.linear().col(0)), -0.99) << i;
        EXPECT_GT(went.linear().col(2).dot(comes.linear().col(2)), 0.99) << i;
    }
}
}  // namespace
