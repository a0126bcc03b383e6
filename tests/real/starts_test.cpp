// Starts in a bend: ten scans each of another generator, with true poses.
#include <gtest/gtest.h>

#include <cstdio>

#include "command.h"
#include "delio/formats/trajectory.h"
#include "poses.h"
#include "test_data.h"

namespace {
using namespace delio;

class Starts : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(InABend, Starts, testing::Values("rural_in_a_bend", "highway_in_a_curve"));

TEST_P(Starts, FirstMotionIsFound) {
    const std::string data = std::string("starts/") + GetParam();
    DELIO_NEED_DATA(data);
    const test::TemporaryFolder folder;
    const std::string drive = test::dataFolder() / data, out = folder / "out";
    const auto slam = test::runTool("delio-slam", {"-i", drive, "-o", out, "--no-map", "--set",
                                                   "scan.vertical_correction_deg=0"});
    ASSERT_EQ(slam.exitCode, 0) << slam.err;
    const auto Tr = io::readCalibration(drive + "/calib.txt").Tr;
    const auto truth = io::readTrajectory(drive + "/poses.txt").poses;
    const auto found = io::readTrajectory(out + "/trajectory_odometry_kitti.txt").poses;
    ASSERT_EQ(found.size(), truth.size());
    constexpr double kMetres = 0.15, kDegrees = 0.3, kEnd_m = 0.05;
    for (std::size_t i = 1; i < truth.size(); ++i) {
        const Eigen::Isometry3d moved = Tr.inverse() * truth[i - 1].inverse() * truth[i] * Tr,
                                step = found[i - 1].inverse() * found[i];
        EXPECT_LT(test::metresBetween(step, moved), kMetres) << i;
        EXPECT_LT(test::degreesBetween(step, moved), kDegrees) << i;
    }
    const Eigen::Isometry3d moved = Tr.inverse() * truth[0].inverse() * truth.back() * Tr;
    EXPECT_LT(test::metresBetween(found[0].inverse() * found.back(), moved), kEnd_m);
}
}  // namespace
