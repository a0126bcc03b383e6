// Even scans of a real drive as the map, odd ones localised in it.
#include <gtest/gtest.h>

#include "command.h"
#include "delio/evaluation/metrics.h"
#include "delio/run/run_folder.h"
#include "test_data.h"

namespace {
using namespace delio;

TEST(RealStoredMap, OddScansAreFoundAmongEvenOnes) {
    DELIO_NEED_DATA("kitti/drive0005_first60");
    const test::TemporaryFolder folder;
    const std::string rawlog = folder / "d.rawlog";
    const auto sequence = test::dataFolder() / "kitti/drive0005_first60";
    ASSERT_EQ(test::runTool("kitti2rawlog", {"-i", sequence, "-o", rawlog}).exitCode, 0);
    const auto slam = [&](const std::string& out, const std::vector<std::string>& more) {
        std::vector<std::string> words{"-i", rawlog, "-o", folder / out};
        words.insert(words.end(), more.begin(), more.end());
        const auto run = test::runTool("delio-slam", words);
        EXPECT_EQ(run.exitCode, 0) << run.err;
        return run::RunFolder(folder / out);
    };
    slam("even", {"--every", "2"});
    const auto odd =
        slam("odd", {"--start", "1", "--every", "2", "--no-map", "--map", folder / "even"});
    const auto all = slam("all", {"--no-map"}).trajectory().poses;
    std::vector<Eigen::Isometry3d> wanted;
    for (const auto& row : odd.localisation()) wanted.push_back(all.at(row.scan));
    const auto error = evaluation::poseError(wanted, odd.trajectory().poses);
    std::printf("odd scans: %.4f m %.4f deg median, %.4f m at most, %zu of %zu in the map\n",
                error.translation_m.median, error.rotation_deg.median, error.translation_m.max,
                odd.summary().in_map, odd.summary().scans);
    EXPECT_LT(error.translation_m.median, 0.02);
    EXPECT_GE(odd.summary().in_map + 3, odd.summary().scans);
}
}  // namespace
