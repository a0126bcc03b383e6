// KITTI in; trajectory, map and picture out: the figures that README states, through the tools.
#include <gtest/gtest.h>
#include <mrpt/containers/yaml.h>
#include <mrpt/img/CImage.h>

#include <cstdio>
#include <set>

#include "command.h"
#include "delio/evaluation/metrics.h"
#include "delio/formats/trajectory.h"
#include "poses.h"
#include "test_data.h"

namespace {
using namespace delio;
using mrpt::containers::yaml;

/** kitti2rawlog and delio-slam on one extract; its summary. */
yaml runOn(const std::string& extract, const test::TemporaryFolder& folder,
           const std::string& profile, const std::vector<std::string>& more = {}) {
    const auto sequence = test::dataFolder() / "kitti" / extract;
    const std::string rawlog = folder / (extract + ".rawlog");
    const std::string out = folder / (extract + profile);
    if (!std::filesystem::exists(rawlog)) {
        const auto converted = test::runTool("kitti2rawlog", {"-i", sequence, "-o", rawlog});
        EXPECT_EQ(converted.exitCode, 0) << converted.err;
    }
    std::vector<std::string> words{"-i", rawlog, "-o", out, "--profile", profile};
    words.insert(words.end(), more.begin(), more.end());
    const auto slam = test::runTool("delio-slam", words);
    EXPECT_EQ(slam.exitCode, 0) << slam.err;
    std::printf("== %s, %s\n%s", extract.c_str(), profile.c_str(), slam.out.c_str());
    return yaml::FromFile(out + "/summary.yaml");
}

/** Streets, not an empty frame: much of the picture is drawn on, in many colours. */
void expectPictureOfMap(const std::string& file) {
    mrpt::img::CImage picture;
    ASSERT_TRUE(picture.loadFromFile(file));
    std::set<int> colours;
    std::size_t drawn = 0;
    const auto background = picture.at<uint8_t>(5, 5, 0);
    for (unsigned y = 0; y < picture.getHeight(); y += 2)
        for (unsigned x = 0; x < picture.getWidth(); x += 2) {
            const int r = picture.at<uint8_t>(x, y, 0), g = picture.at<uint8_t>(x, y, 1),
                      b = picture.at<uint8_t>(x, y, 2);
            drawn += std::abs(r - background) > 30;
            colours.insert(r / 32 * 64 + g / 32 * 8 + b / 32);
        }
    EXPECT_GT(drawn, picture.getWidth() * picture.getHeight() / 4 / 20);
    EXPECT_GT(colours.size(), 30U);
}

/** No step far from that of another odometry on the same scans. */
void expectStepsOfKissIcp(const std::string& extract, const std::string& out) {
    DELIO_NEED_DATA("peers/kiss_icp");
    const auto peer =
        io::readTrajectory((test::dataFolder() / "peers/kiss_icp" / (extract + ".txt")).string());
    const auto own = io::readTrajectory(out + "/trajectory_kitti.txt");
    const auto apart = evaluation::relativeError(peer.poses, own.poses);
    std::printf("%s, steps from KISS-ICP's: at most %.3f m, %.3f deg\n", extract.c_str(),
                apart.translation_m.max, apart.rotation_deg.max);
    EXPECT_LT(apart.translation_m.max, 0.08);
    EXPECT_LT(apart.rotation_deg.max, 0.25);
}

// KISS-ICP with the same correction has medians of 0.019 m and 0.056 deg on the first, and of 0.075
// deg (95 %: 0.155) on the second.
TEST(EndToEnd, AccurateOnBothExtracts) {
    DELIO_NEED_DATA("kitti/00_first16");
    const test::TemporaryFolder folder;
    auto of00 = runOn("00_first16", folder, "accurate");
    EXPECT_EQ(of00["predicted"].as<int>(), 0);
    EXPECT_LT(of00["metrics"]["scan_translation_median_m"].as<double>(), 0.019);
    EXPECT_LT(of00["metrics"]["scan_rotation_median_deg"].as<double>(), 0.056);
    expectStepsOfKissIcp("00_first16", folder / "00_first16accurate");
    DELIO_NEED_DATA("kitti/drive0005_first60");
    auto of0005 = runOn("drive0005_first60", folder, "accurate");
    EXPECT_EQ(of0005["predicted"].as<int>(), 0);
    EXPECT_LT(of0005["metrics"]["scan_rotation_median_deg"].as<double>(), 0.06);
    // (0.119 without points: its scans are skewed by their motion.)
    EXPECT_LT(of0005["metrics"]["scan_rotation_p95_deg"].as<double>(), 0.13);
    expectStepsOfKissIcp("drive0005_first60", folder / "drive0005_first60accurate");
}

// Hardly a wall: planes alone are 0.4 deg off about the vertical. Figures of KISS-ICP, to be met.
TEST(EndToEnd, TheHighwayOfSequence01) {
    DELIO_NEED_DATA("kitti/01_first10");
    const test::TemporaryFolder folder;
    auto of01 = runOn("01_first10", folder, "accurate");
    EXPECT_EQ(of01["predicted"].as<int>(), 0);
    EXPECT_LT(of01["metrics"]["scan_translation_median_m"].as<double>(), 0.048);
    EXPECT_LT(of01["metrics"]["scan_rotation_median_deg"].as<double>(), 0.047);
}

TEST(EndToEnd, FirstScansOfSequence00) {
    DELIO_NEED_DATA("kitti/00_first16");
    const test::TemporaryFolder folder;
    const auto summary = runOn("00_first16", folder, "paper");
    EXPECT_EQ(summary["scans"].as<int>(), 16);
    EXPECT_EQ(summary["predicted"].as<int>(), 0);
    EXPECT_TRUE(summary["complete"].as<bool>());
    EXPECT_DOUBLE_EQ(summary["vertical_correction_deg"].as<double>(), 0);  // as it is
    EXPECT_LT(summary["metrics"]["end_error_percent"].as<double>(), 1.5);
    EXPECT_LT(summary["metrics"]["scan_rotation_median_deg"].as<double>(), 0.10);
    const std::string out = folder / "00_first16paper";
    EXPECT_EQ(io::readTrajectory(out + "/trajectory_kitti.txt").poses.size(), 16U);
    expectPictureOfMap(out + "/map.png");

    // The second reference for these scans: SiMpLE's trajectory.
    DELIO_NEED_DATA("evaluator/offline/00.txt");
    auto simple = io::readTrajectory((test::dataFolder() / "evaluator/offline/00.txt").string());
    simple.poses.resize(16);
    const auto own = io::readTrajectory(out + "/trajectory_kitti_cam0.txt");
    const auto error = evaluation::relativeError(simple.poses, own.poses);
    const double end = test::metresBetween(test::fromFirst(own.poses).back(),
                                           test::fromFirst(simple.poses).back());
    std::printf("against SiMpLE: per scan %.4f m, %.4f deg median; end %.3f m\n",
                error.translation_m.median, error.rotation_deg.median, end);
    EXPECT_LT(end, 0.015 * 11.7);
}

TEST(EndToEnd, FirstScansOfDrive0005) {
    DELIO_NEED_DATA("kitti/drive0005_first60");
    const test::TemporaryFolder folder;
    const auto summary = runOn("drive0005_first60", folder, "paper", {"--count", "30"});
    EXPECT_EQ(summary["scans"].as<int>(), 30);
    EXPECT_EQ(summary["predicted"].as<int>(), 0);
    EXPECT_LT(summary["metrics"]["scan_rotation_median_deg"].as<double>(), 0.12);
    const std::string out = folder / "drive0005_first60paper";
    EXPECT_EQ(io::readTrajectory(out + "/trajectory_tum.txt").poses.size(), 30U);
    expectPictureOfMap(out + "/map.png");
}

/** What a profile gives stays as it is: a change that moves it has to be meant, and to bring new
 *  files. The tolerance is for other compilers. */
TEST(EndToEnd, TrajectoriesAreFrozen) {
    DELIO_NEED_DATA("kitti/00_first16");
    const test::TemporaryFolder folder;
    for (const std::string profile : {"paper", "accurate"}) {
        runOn("00_first16", folder, profile);
        for (const std::string part : {"", "_odometry"}) {
            const auto frozen = io::readTrajectory(
                (test::frozenFolder() / ("00_first16_" + profile + part + ".txt")).string());
            const std::string out = folder / ("00_first16" + profile);
            const auto own = io::readTrajectory(out + "/trajectory" + part + "_kitti.txt");
            ASSERT_EQ(own.poses.size(), frozen.poses.size());
            for (std::size_t i = 0; i < own.poses.size(); ++i) {
                EXPECT_LT(test::metresBetween(own.poses[i], frozen.poses[i]), 1e-3)
                    << profile << part << i;
                EXPECT_LT(evaluation::rotationAngle_rad(frozen.poses[i].inverse() * own.poses[i]),
                          1e-4)
                    << profile << part << i;
            }
        }
    }
}

TEST(EndToEnd, PaperLiteralRunsToo) {
    DELIO_NEED_DATA("kitti/00_first16");
    const test::TemporaryFolder folder;
    const auto summary = runOn("00_first16", folder, "paper-literal");
    EXPECT_EQ(summary["scans"].as<int>(), 16);
    EXPECT_EQ(summary["predicted"].as<int>(), 0);
    // Reported beside the paper profile, no target: it is at 0.98 % and 0.25 deg.
    EXPECT_LT(summary["metrics"]["end_error_percent"].as<double>(), 2);
    EXPECT_LT(summary["metrics"]["scan_rotation_median_deg"].as<double>(), 0.4);
}
}  // namespace
