#include <gtest/gtest.h>
#include <mrpt/img/CImage.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <utility>
#include <vector>

#include "command.h"
#include "delio/formats/trajectory.h"
#include "delio/picture/scene.h"
#include "test_data.h"
#include "toy_drive.h"

namespace {
using namespace delio;

std::string toyRawlog(const test::TemporaryFolder& folder, std::size_t scans) {
    test::writeSequence(folder / "toy", test::toyScans(scans));
    std::string rawlog = folder / "toy.rawlog";
    const auto converted = test::runTool("kitti2rawlog", {"-i", folder / "toy", "-o", rawlog});
    EXPECT_EQ(converted.exitCode, 0) << converted.err;
    return rawlog;
}

/** Share of the pixels that have a colour, which what is drawn has, and neither the background nor
 *  grids and captions have. */
double colouredShare(const mrpt::img::CImage& picture) {
    std::size_t coloured = 0;
    for (unsigned y = 0; y < picture.getHeight(); ++y)
        for (unsigned x = 0; x < picture.getWidth(); ++x) {
            const auto* bgr = picture.ptr<std::uint8_t>(x, y);
            const auto [low, high] = std::minmax({bgr[0], bgr[1], bgr[2]});
            coloured += high - low > 40;
        }
    return static_cast<double>(coloured) /
           static_cast<double>(picture.getWidth() * picture.getHeight());
}

TEST(DelioFigures, MakesASceneAndAPictureOfEachStage) {
    const test::TemporaryFolder folder;
    const std::string rawlog = toyRawlog(folder, 4);
    const std::string out = folder / "figures";
    const auto made = test::runTool("delio-figures", {"-i", rawlog, "-o", out});
    ASSERT_EQ(made.exitCode, 0) << made.err;
    EXPECT_EQ(made.out, "");
    // Dots on spheres, or lines all over: about half of what there is.
    const std::vector<std::pair<std::string, double>> figures = {{"scanner", 0.03},
                                                                 {"cloud", 0.05},
                                                                 {"sphere", 0.001},
                                                                 {"normals_sphere", 0.001},
                                                                 {"outlier_removal", 0.002},
                                                                 {"mean_shift", 0.004},
                                                                 {"line_bin", 0.01},
                                                                 {"line_cloud", 0.05},
                                                                 {"line_matches_before", 0.05},
                                                                 {"line_matches_after", 0.05}};
    for (const auto& [name, share] : figures) {
        EXPECT_TRUE(picture::loadScene(out + "/" + name + ".3Dscene"));
        mrpt::img::CImage picture;
        EXPECT_TRUE(picture.loadFromFile(out + "/" + name + ".png"));
        EXPECT_GE(picture.getWidth(), 500U);
        EXPECT_GT(colouredShare(picture), share) << name;
    }
    // The profile that draws no lines of its own gives the same figures.
    EXPECT_EQ(test::runTool("delio-figures",
                            {"-i", rawlog, "-o", folder / "accurate", "--profile", "accurate"})
                  .exitCode,
              0);
    // They are not overwritten unless that is wanted.
    const auto again = test::runTool("delio-figures", {"-i", rawlog, "-o", out});
    EXPECT_EQ(again.exitCode, 1);
    EXPECT_NE(again.err.find("--force"), std::string::npos);
    EXPECT_EQ(test::runTool("delio-figures", {"-i", rawlog, "-o", out, "--force"}).exitCode, 0);
}

TEST(DelioFigures, BadInput) {
    const test::TemporaryFolder folder;
    const std::string rawlog = toyRawlog(folder, 3);
    const std::string out = folder / "figures";
    const auto expect = [&](const std::vector<std::string>& options, int code,
                            const std::string& what) {
        const auto run = test::runTool("delio-figures", options);
        EXPECT_EQ(run.exitCode, code) << what;
        EXPECT_NE(run.err.find(what), std::string::npos) << run.err;
    };
    expect({"-i", folder / "none.rawlog", "-o", out}, 1, "none.rawlog");
    expect({"-i", rawlog, "-o", out, "--scan", "2"}, 1, "fewer than two scans from scan 2");
    expect({"-i", rawlog, "-o", out, "--set", "normals.k=3"}, 2, "normals.k");
    expect({"-i", rawlog, "-o", out, "--profile", "best"}, 2, "best");
    expect({"-i", rawlog, "-o", rawlog}, 1, "is not a folder");
    EXPECT_FALSE(std::filesystem::exists(out + "/normals_sphere.png"));
}

/** share/scripts/figures, which finds this build's programs. */
class FiguresScript : public testing::Test {
 protected:
    void SetUp() override {
        const std::filesystem::path tool = test::toolPath("delio-figures");
        path_ = getenv("PATH");
        setenv("PATH", (tool.parent_path().string() + ":" + path_).c_str(), 1);
    }
    void TearDown() override { setenv("PATH", path_.c_str(), 1); }

    static test::CommandResult run(const std::vector<std::string>& words) {
        return test::runTool(test::profileFolder().parent_path() / "scripts/figures", words);
    }

    /** A file of poses that drive as far as `scans` metres ahead, and turn left by 5 deg a scan
     *  from scan `from` to scan `to`. In the axes of cam0, or in those of a LiDAR. */
    std::string poses(const std::string& name, int scans, int from, int to, bool cam0) const {
        Eigen::Matrix3d axes;  // of a LiDAR, in those of cam0
        axes << 0, -1, 0, 0, 0, -1, 1, 0, 0;
        if (!cam0) axes.setIdentity();
        Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
        io::Trajectory trajectory;
        for (int i = 0; i < scans; ++i) {
            trajectory.poses.push_back(Eigen::Isometry3d(axes) * pose *
                                       Eigen::Isometry3d(axes).inverse());
            const double turn = i >= from && i < to ? 5 * M_PI / 180 : 0;
            pose = pose * Eigen::Translation3d(1, 0, 0) *
                   Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ());
        }
        io::writeKitti(trajectory, folder_ / name);
        return folder_ / name;
    }

    test::TemporaryFolder folder_;
    std::string path_;
};

TEST_F(FiguresScript, MakesEveryFigureOfADriveAndShowsWhereItTurns) {
    const std::string rawlog = toyRawlog(folder_, 14), results = folder_ / "results";
    ASSERT_EQ(test::runTool("delio-slam", {"-i", rawlog, "-o", results}).exitCode, 0);
    poses("results/trajectory_kitti.txt", 14, 3, 6, false);
    const std::string out = folder_ / "my figures";
    const auto made = run({rawlog, results, out});
    ASSERT_EQ(made.exitCode, 0) << made.err;
    EXPECT_NE(made.err.find("draws scan 0, and every scan that is 3"), std::string::npos);
    for (const std::string name :
         {"teaser", "normals_sphere", "outlier_removal", "mean_shift", "line_bin", "line_cloud",
          "line_matches_before", "line_matches_after", "map", "map_top", "map_intensity",
          "trajectory"}) {
        mrpt::img::CImage picture;
        ASSERT_TRUE(picture.loadFromFile(out + "/" + name + ".png")) << name;
        EXPECT_EQ(picture.at<std::uint8_t>(0, 0, 0), 255) << name;
        EXPECT_GT(colouredShare(picture), 0.0005) << name;
    }
    for (const char* name : {"teaser.pdf", "trajectory.pdf", "overview.svg"})
        EXPECT_TRUE(std::filesystem::exists(out + "/" + name)) << name;

    poses("results/trajectory_kitti.txt", 14, 7, 10, false);
    const auto one = run({"pattern", rawlog, results, folder_ / "one", "", "1"});
    ASSERT_EQ(one.exitCode, 0) << one.err;
    EXPECT_NE(one.err.find("draws scan 7, and every scan that is 1"), std::string::npos) << one.err;
    EXPECT_EQ(test::namesIn(folder_ / "one"), std::vector<std::string>{"normals_sphere.png"});
}

TEST_F(FiguresScript, DrawsSeveralMethodsInTheirFrames) {
    const std::string truth = poses("truth.txt", 60, 20, 30, true);
    const std::string lidar = poses("lidar.txt", 60, 20, 30, false);
    const std::string other = poses("other.txt", 60, 30, 40, true);
    const std::string out = folder_ / "methods";
    const auto blue = [&](const std::vector<std::string>& words) {
        std::vector<std::string> all = {"methods", out};
        all.insert(all.end(), words.begin(), words.end());
        const auto made = run(all);
        EXPECT_EQ(made.exitCode, 0) << made.err;
        EXPECT_TRUE(std::filesystem::exists(out + "/methods.pdf"));
        mrpt::img::CImage picture;
        EXPECT_TRUE(picture.loadFromFile(out + "/methods.png"));
        return colouredShare(picture);
    };
    // A trajectory covers the one that it equals, whatever frames they are in.
    const double same = blue({"truth=" + lidar, "DeLiO's=" + truth});
    EXPECT_GT(same, 0.001);
    EXPECT_NEAR(blue({"truth=" + truth, "DeLiO's=" + lidar}), same, 0.1 * same);
    EXPECT_GT(blue({"truth=" + truth, "other=" + other}), 1.2 * same);
    blue({"a=" + truth, "b=" + lidar, "c=" + other, "d=" + truth, "e=" + lidar, "f=" + other});

    const std::string tum = folder_ / "tum.txt";
    test::writeText(tum, "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n");
    const auto expect = [&](const std::string& word, int code, const std::string& what) {
        const auto refused = run({"methods", out, word});
        EXPECT_EQ(refused.exitCode, code) << word;
        EXPECT_NE(refused.err.find(what), std::string::npos) << refused.err;
    };
    expect("a=" + tum, 1, "is not a trajectory in KITTI's format");
    expect("a=none", 1, "there is no file");
    expect(truth, 2, "is not NAME=POSES");
    expect("truth=" + truth, 2, "give 1 to 26 trajectories");
}

TEST_F(FiguresScript, PutsMeasuredRowsBelowPublishedOnes) {
    const std::string metrics = folder_ / "metrics.tsv";
    test::writeText(metrics,
                    "name\tsequence\tlength_m\tsegments\tt_percent\tr_deg_per_100m\n"
                    "mine\t05\t700\t9\t1.25\t0.5\nmine\t07\t700\t9\t2.25\t0.5\n"
                    "mine\tavg\t1400\t18\t1.75\t0.5\n");
    const auto table = run({"table", metrics});
    ASSERT_EQ(table.exitCode, 0) << table.err;
    EXPECT_NE(table.out.find("| DeLiO (paper) | 5.32 | 2.13 |"), std::string::npos) << table.out;
    EXPECT_NE(table.out.find("| **mine** | 1.750 | 0.500 | 05 07 | measured |"), std::string::npos)
        << table.out;
    EXPECT_EQ(run({"table", folder_ / "none.tsv"}).exitCode, 1);
    EXPECT_EQ(run({"table"}).exitCode, 2);
    EXPECT_EQ(run({"map", "only.rawlog"}).exitCode, 2);
    EXPECT_EQ(run({"map", "a.rawlog", folder_ / "none", folder_ / "out"}).exitCode, 1);
}
}  // namespace
