#include "evaluation/known_faults.h"

#include <gtest/gtest.h>

#include "poses.h"

namespace {
using delio::evaluation::knownFaultOf;
using delio::test::poseAt;
using Poses = std::vector<Eigen::Isometry3d>;

/** As KITTI's official poses of 00 begin, to some millimetres: the same step again and again, then
 *  speeds that change. */
Poses kitti00(std::size_t count) {
    Poses poses;
    for (std::size_t i = 0; i < count; ++i) {
        const double t = static_cast<double>(i), late = std::max(0.0, t - 15);
        poses.push_back(poseAt(-0.0469 * t, -0.0284 * t, 0.8582 * t + 0.01 * late * late));
    }
    return poses;
}

TEST(KnownFaults, TheHeadOfKitti00IsRecognised) {
    const auto poses = kitti00(100);
    EXPECT_NE(knownFaultOf(poses).find("15 of the 100 true poses"), std::string::npos);
    EXPECT_NE(knownFaultOf({poses.begin() + 5, poses.begin() + 15}), "");  // --start, --count
}

TEST(KnownFaults, AStretchThatIsNoPartOfTheDriveToSpeakOfIsNoWarning) {
    EXPECT_EQ(knownFaultOf(kitti00(4541)), "");
    EXPECT_EQ(knownFaultOf({}), "");
}

TEST(KnownFaults, OtherDrivesAreNot) {
    const auto poses = kitti00(200);
    EXPECT_EQ(knownFaultOf({poses.begin() + 16, poses.end()}), "");
    Poses straight, slower;
    for (int i = 0; i < 16; ++i) {
        straight.push_back(poseAt(0, 0, 0.8582 * i));
        slower.push_back(poseAt(-0.04 * i, -0.025 * i, 0.78 * i));  // as odometries have it
    }
    EXPECT_EQ(knownFaultOf(straight), "");
    EXPECT_EQ(knownFaultOf(slower), "");
}
}  // namespace
