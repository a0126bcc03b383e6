// Real scans of other sensors than KITTI's, beside KISS-ICP's poses of the same scans.
#include <gtest/gtest.h>
#include <mrpt/containers/yaml.h>

#include <algorithm>
#include <cstdio>

#include "command.h"
#include "delio/formats/trajectory.h"
#include "poses.h"
#include "test_data.h"

namespace {
using namespace delio;
using mrpt::containers::yaml;

struct Drive {
    std::string data, profile;
    double within;  //!< of KISS-ICP's path
};

class OtherSensors : public testing::TestWithParam<Drive> {};
INSTANTIATE_TEST_SUITE_P(Real, OtherSensors,
                         testing::Values(Drive{"vlp16_street_first80", "accurate", 0.02},
                                         Drive{"os1_kaist03_21", "accurate", 0.02},
                                         Drive{"vlp16_street_first80", "paper-extended", 0.05}),
                         [](const auto& drive) {
                             auto name = drive.param.data + "_" + drive.param.profile;
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

double pathOf(const io::Trajectory& drive) {
    double path_m = 0;
    for (std::size_t i = 1; i < drive.poses.size(); ++i)
        path_m += test::metresBetween(drive.poses[i - 1], drive.poses[i]);
    return path_m;
}

TEST_P(OtherSensors, LeadWhereKissIcpLeads) {
    const auto& [data, profile, within] = GetParam();
    const std::string peerFile = "peers/kiss_icp/" + data + ".txt";
    DELIO_NEED_DATA("real/" + data);
    DELIO_NEED_DATA(peerFile);
    const test::TemporaryFolder folder;
    const std::string rawlog = folder / "drive.rawlog", out = folder / "out";
    const auto converted =
        test::runTool("kitti2rawlog", {"-i", test::dataFolder() / "real" / data, "-o", rawlog});
    ASSERT_EQ(converted.exitCode, 0) << converted.err;
    const auto slam =
        test::runTool("delio-slam", {"-i", rawlog, "-o", out, "--profile", profile, "--no-map",
                                     "--set", "scan.vertical_correction_deg=0"});
    ASSERT_EQ(slam.exitCode, 0) << slam.err;
    EXPECT_EQ(yaml::FromFile(out + "/summary.yaml")["predicted"].as<int>(), 0);
    const auto peer = io::readTrajectory((test::dataFolder() / peerFile).string());
    const auto own = io::readTrajectory(out + "/trajectory_kitti.txt");
    ASSERT_EQ(own.poses.size(), peer.poses.size());
    const double path_m = pathOf(own), peerPath_m = pathOf(peer),
                 apart_m = test::metresBetween(test::fromFirst(own.poses).back(),
                                               test::fromFirst(peer.poses).back());
    std::printf("path %.3f m, KISS-ICP's %.3f m; ends %.3f m apart\n", path_m, peerPath_m, apart_m);
    EXPECT_NEAR(path_m, peerPath_m, within * peerPath_m);
    EXPECT_LT(apart_m, within * peerPath_m);
}
}  // namespace
