// What a tool reads is not what it writes, whatever the names.
#include "delio/formats/trajectory.h"
#include "drive_state.h"
#include "kitti_tools.h"
#include "poses.h"

namespace {
using namespace delio;
using test::Words;
namespace fs = std::filesystem;

class ConvertersOverlap : public test::KittiTools {
 protected:
    /** The tool says so in one line, and changes nothing. */
    void expectRefusal(const std::string& tool, const Words& words) {
        const auto before = test::stateOf(folder_.path());
        const auto run = test::runTool(tool, words);
        test::expectFailure(run, 1, {"input", "choose another output"});
        EXPECT_TRUE(test::stateOf(folder_.path()) == before) << tool << " " << run.err;
        EXPECT_FALSE(test::hasLeftovers(folder_.path())) << tool;
    }
};

TEST_F(ConvertersOverlap, Kitti2rawlog) {
    const fs::path sequence = folder_ / "kp_Images";
    fs::rename(seq_, sequence);
    expectRefusal("kitti2rawlog",
                  {"-i", sequence, "-o", folder_ / "kp.rawlog", "--embed", "--force"});
    expectRefusal("kitti2rawlog",
                  {"-i", sequence, "-o", folder_ / "kp.rawlog", "--link", "--force"});
    fs::create_directory(folder_ / "part");
    for (const char* name : {"calib.txt", "times.txt", "poses.txt", "velodyne"})
        fs::create_symlink(sequence / name, folder_ / "part" / name);
    expectRefusal("kitti2rawlog", {"-i", folder_ / "part", "-o", folder_ / "kp.rawlog", "--force"});
    fs::rename(sequence / "times.txt", folder_ / "d.times.txt");
    fs::create_symlink(folder_ / "d.times.txt", sequence / "times.txt");
    expectRefusal("kitti2rawlog", {"-i", sequence, "-o", folder_ / "d.rawlog", "--force"});
    EXPECT_EQ(test::runTool("kitti2rawlog", {"-i", sequence, "-o", sequence / "d.rawlog"}).exitCode,
              0)
        << "beside what is read there is room";
}

TEST_F(ConvertersOverlap, Synth2rawlog) {
    std::vector<Eigen::Isometry3d> poses;
    for (int i = 0; i < 30; ++i) poses.push_back(test::poseAt(0, 0, i));
    io::writeKitti({poses, {}}, folder_ / "d.poses.txt");
    const Words words = {"--scene", "urban", "--scans", "2", "--force", "--sensor", "vlp16"};
    for (const fs::path& name : {fs::path("d.poses.txt"), fs::path("link.txt")}) {
        if (name == "link.txt") fs::create_symlink("d.poses.txt", folder_ / name);
        Words all = {"--trajectory", folder_ / name, "-o", folder_ / "d.rawlog"};
        all.insert(all.end(), words.begin(), words.end());
        expectRefusal("synth2rawlog", all);
    }
}

TEST_F(ConvertersOverlap, Scans2rawlog) {
    ASSERT_EQ(toRawlog().exitCode, 0);
    expectRefusal("scans2rawlog", {"-i", rawlog_, "-o", rawlog_, "--force"});
    fs::create_symlink(rawlog_, folder_ / "link.rawlog");
    expectRefusal("scans2rawlog", {"-i", folder_ / "link.rawlog", "-o", rawlog_, "--force",
                                   "--images", side("_Images")});
    expectRefusal("scans2rawlog", {"-i", rawlog_, "-o", folder_ / "link.rawlog", "--force"});
    fs::create_directory_symlink(side("_Images"), folder_ / "e_Images");
    expectRefusal("scans2rawlog", {"-i", rawlog_, "-o", folder_ / "e.rawlog", "--force"});
    fs::rename(seq_, folder_ / "s_Images");
    expectRefusal("scans2rawlog",
                  {"-i", folder_ / "s_Images", "-o", folder_ / "s.rawlog", "--force"});
    fs::rename(rawlog_, folder_ / "out" / "d.dat");
    expectRefusal("scans2rawlog", {"-i", folder_ / "out" / "d.dat", "-o", rawlog_, "--force"});
    fs::rename(folder_ / "out" / "d.dat", rawlog_);
    const Words again = {"-i", rawlog_, "-o", folder_ / "t.rawlog", "--force"};
    for (int i = 0; i < 2; ++i)
        EXPECT_EQ(test::runTool("scans2rawlog", again).exitCode, 0) << "and again";
}

TEST_F(ConvertersOverlap, Rawlog2kitti) {
    ASSERT_EQ(toRawlog({"--link"}).exitCode, 0);
    expectRefusal("rawlog2kitti", {"-i", rawlog_, "-o", seq_, "--force"});
    ASSERT_EQ(toRawlog({"--force"}).exitCode, 0);
    fs::create_directories(folder_ / "other");
    fs::rename(side("_Images"), folder_ / "other" / "velodyne");
    expectRefusal("rawlog2kitti", {"-i", rawlog_, "-o", folder_ / "other", "--force", "--images",
                                   folder_ / "other" / "velodyne"});
    EXPECT_EQ(toKitti(seq_, {"--force", "--images", folder_ / "other" / "velodyne"}).exitCode, 0);
}

TEST_F(ConvertersOverlap, MapsAndPictures) {
    test::writeText(folder_ / "map.ply", "ply");
    fs::create_symlink("map.ply", folder_ / "picture.png");
    fs::create_symlink("map.ply", folder_ / "link.ply");
    expectRefusal("delio-map", {"-i", folder_ / "map.ply", "-o", folder_ / "link.ply", "--force"});
    expectRefusal("delio-snapshot",
                  {"-i", folder_ / "map.ply", "-o", folder_ / "picture.png", "--force"});
    fs::create_directory(folder_ / "run");
    for (const char* name : {"map.ply", "map_dynamic.ply"})
        test::writeText(folder_ / "run" / name, "ply");
    expectRefusal("delio-map",
                  {"-i", folder_ / "run", "-o", folder_ / "run" / "map_dynamic.ply", "--force"});
    ASSERT_EQ(toRawlog().exitCode, 0);
    fs::create_directory(folder_ / "figures");
    fs::rename(rawlog_, folder_ / "figures" / "line_cloud.png");
    expectRefusal("delio-figures", {"-i", folder_ / "figures" / "line_cloud.png", "-o",
                                    folder_ / "figures", "--force"});
}

TEST_F(ConvertersOverlap, Reports) {
    fs::create_directories(folder_ / "report" / "plots");
    fs::copy_file(seq_ / "poses.txt", folder_ / "report" / "plots" / "poses.txt");
    fs::copy_file(seq_ / "poses.txt", folder_ / "report" / "metrics.tsv");
    for (const char* name : {"plots/poses.txt", "metrics.tsv"})
        expectRefusal("delio-eval",
                      {"--ref", seq_ / "poses.txt", "--est", folder_ / "report" / name, "-o",
                       folder_ / "report", "--force"});
    expectRefusal("delio-eval", {"--est", seq_ / "poses.txt", "--ref", folder_ / "report" / "plots",
                                 "-o", folder_ / "report", "--force"});
}
}  // namespace
