// A LiDAR whose pattern does not repeat, as Livox's driver records it: delio-slam finds its way.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "command.h"
#include "delio/formats/trajectory.h"
#include "rosette.h"
#include "scan_columns.h"
#include "test_data.h"

namespace {
using namespace delio;

TEST(Livox, TrajectoryOfANonRepetitivePattern) {
    const test::TemporaryFolder folder;
    for (const double message_s : {0.1, 0.02}) {
        test::RosetteDrive drive;
        drive.message_s = message_s;
        drive.kind = test::WireWriter::Kind::kCdr;
        drive.driver2 = true;
        const std::string bag = folder / "livox.mcap", out = folder / "out";
        writeMcap(bag, rosetteBag(drive), "zstd");
        const auto slam =
            test::runTool("delio-slam", {"-i", bag, "-o", out, "--no-map", "--force"});
        ASSERT_EQ(slam.exitCode, 0) << slam.err;
        EXPECT_NE(slam.err.find("reading Livox, 10 Hz, points with times, not de-skewed by the "
                                "recorder"),
                  std::string::npos)
            << slam.err;
        const auto trajectory = io::readTrajectory(out + "/trajectory_kitti.txt");
        ASSERT_EQ(trajectory.poses.size(), 60U);
        const Eigen::Isometry3d first = test::rosettePose(0);
        double worst_m = 0, worst_rad = 0;
        for (std::size_t i = 0; i < trajectory.poses.size(); ++i) {
            const Eigen::Isometry3d truth =
                first.inverse() * test::rosettePose(0.1 * static_cast<double>(i));
            const Eigen::Isometry3d off = truth.inverse() * trajectory.poses[i];
            worst_m = std::max(worst_m, off.translation().norm());
            worst_rad = std::max(worst_rad, Eigen::AngleAxisd(off.linear()).angle());
        }
        EXPECT_LT(worst_m, 0.05) << message_s;
        EXPECT_LT(worst_rad, 0.01) << message_s;
    }
}
}  // namespace
