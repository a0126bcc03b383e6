// What is written: by one program at a time, under names that nobody can guess, for whom the umask
// says, and whole or not at all.
#include <csignal>
#include <thread>

#include "delio/map/cloud_files.h"
#include "drive_state.h"
#include "kitti_tools.h"

namespace {
using namespace delio;
using test::Words;
namespace fs = std::filesystem;

class ConvertersOutput : public test::KittiTools {
 protected:
    /** While the first writes `folder`, the second is refused. */
    void expectOneAtATime(const std::string& tool, const Words& slow, const Words& fast,
                          const fs::path& folder) {
        test::RunningTool first(tool, slow);
        const auto writes = [&] {
            std::error_code ignored;
            for (const auto& entry : fs::directory_iterator(folder, ignored))
                if (entry.path().filename().string().rfind(".partial-", 0) == 0 &&
                    entry.is_directory(ignored))
                    return true;
            return false;
        };
        while (!first.hasEnded() && !writes()) std::this_thread::yield();
        ASSERT_FALSE(first.hasEnded());
        first.send(SIGSTOP);
        const auto second = test::runTool(tool, fast);
        test::expectFailure(second, 1, {"is being written by another program"});
        first.send(SIGCONT);
        const auto ended = first.wait();
        EXPECT_EQ(ended.exitCode, 0) << ended.err;
        EXPECT_FALSE(test::hasLeftovers(folder_.path()));
        EXPECT_EQ(test::runTool(tool, fast).exitCode, 0) << "afterwards it may";
    }

    /** A map of a few points. */
    std::string writeMap() const {
        map::MapPoints points(2000);
        for (std::size_t i = 0; i < points.size(); ++i)
            points[i].position = {static_cast<float>(i % 50), static_cast<float>(i) / 50, 0};
        map::savePly(points, folder_ / "map.ply");
        return folder_ / "map.ply";
    }
};

TEST_F(ConvertersOutput, OneProgramAtATime) {
    const auto synth = [&](const std::string& scans, const std::string& seed) {
        return Words{"-o",     rawlog_, "--force",  "--scene", "urban",     "--scans", scans,
                     "--seed", seed,    "--sensor", "vlp16",   "--threads", "1"};
    };
    expectOneAtATime("synth2rawlog", synth("10", "1"), synth("2", "2"), folder_ / "out");
    test::writeSequence(folder_ / "long", test::fewScans(600));
    const auto kitti = [&](const fs::path& from) {
        return Words{"-i", from, "-o", rawlog_, "--force"};
    };
    expectOneAtATime("kitti2rawlog", kitti(folder_ / "long"), kitti(seq_), folder_ / "out");
    ASSERT_EQ(test::runTool("kitti2rawlog", kitti(folder_ / "long")).exitCode, 0);
    const fs::path other = folder_ / "few.rawlog";
    ASSERT_EQ(test::runTool("kitti2rawlog", {"-i", seq_, "-o", other}).exitCode, 0);
    const auto back = [&](const fs::path& from) {
        return Words{"-i", from, "-o", folder_ / "back", "--force"};
    };
    expectOneAtATime("rawlog2kitti", back(rawlog_), back(other), folder_ / "back");
    EXPECT_EQ(test::namesIn(folder_ / "back").size(), 4U + 5);
}

TEST_F(ConvertersOutput, AFolderThatIsGoneIsOneLine) {
    test::writeSequence(folder_ / "long", test::fewScans(600));
    const auto expectLine = [&](const std::string& tool, const Words& words, const fs::path& gone) {
        test::RunningTool running(tool, words);
        while (!running.hasEnded() && !(fs::exists(gone) && test::hasLeftovers(gone)))
            std::this_thread::yield();
        running.send(SIGSTOP);
        fs::remove_all(gone);
        running.send(SIGCONT);
        test::expectFailure(running.wait(), 1, {"cannot write", gone.string()});
        EXPECT_FALSE(fs::exists(gone));
    };
    const fs::path rawlog = folder_ / "d.rawlog";
    ASSERT_EQ(test::runTool("kitti2rawlog", {"-i", folder_ / "long", "-o", rawlog}).exitCode, 0);
    expectLine("kitti2rawlog", {"-i", folder_ / "long", "-o", rawlog_}, folder_ / "out");
    expectLine("rawlog2kitti", {"-i", rawlog, "-o", folder_ / "back"}, folder_ / "back");
    fs::create_directory(folder_ / "out");
    expectLine("scans2rawlog", {"-i", rawlog, "-o", rawlog_, "--embed"}, folder_ / "out");
}

TEST_F(ConvertersOutput, NobodysLinksAreFollowed) {
    const fs::path mine = folder_ / "mine.txt";
    test::writeText(mine, "mine");
    for (const char* name :
         {".partial-d.rawlog", ".partial-d.meta.yaml", ".partial-d.times.txt", ".partial-d_Images",
          ".partial-p.pcd", ".partial-p.png", ".partial-d.rawlog.lock"})
        fs::create_symlink(mine, folder_ / "out" / name);
    fs::create_symlink(folder_ / "out", folder_ / ".partial-back");
    fs::remove(folder_ / "out" / ".partial-d.rawlog.lock");
    EXPECT_EQ(toRawlog().exitCode, 0);
    EXPECT_EQ(toKitti(folder_ / "back").exitCode, 0);
    const std::string map = writeMap();
    EXPECT_EQ(test::runTool("delio-map", {"-i", map, "-o", folder_ / "out/p.pcd"}).exitCode, 0);
    EXPECT_EQ(
        test::runTool("delio-snapshot", {"-i", map, "-o", folder_ / "out/p.png", "--size", "32x32"})
            .exitCode,
        0);
    EXPECT_EQ(test::readText(mine), "mine");
    EXPECT_TRUE(fs::is_symlink(folder_ / "out/.partial-d.rawlog"));
    EXPECT_TRUE(fs::is_symlink(folder_ / ".partial-back"));
    fs::create_symlink(mine, folder_ / "out" / ".partial-d.rawlog.lock");
    test::expectFailure(toRawlog({"--force"}), 1, {"d.rawlog"});
    EXPECT_EQ(test::readText(mine), "mine");
}

TEST_F(ConvertersOutput, TheUmaskSaysWhoMayRead) {
    const std::string map = writeMap();
    for (const unsigned mask : {0027U, 0077U}) {
        const fs::path out = folder_ / ("mask" + std::to_string(mask));
        fs::create_directory(out);
        const auto run = [&](const std::string& tool, const Words& words) {
            std::string line = (mask == 0027 ? "umask 027; exec '" : "umask 077; exec '") +
                               test::toolPath(tool) + "'";
            for (const auto& word : words) line += " '" + word + "'";
            const auto ended = test::runTool("bash", {"-c", line});
            EXPECT_EQ(ended.exitCode, 0) << tool << ended.err;
        };
        run("kitti2rawlog", {"-i", seq_, "-o", out / "d.rawlog"});
        fs::permissions(out / "d.times.txt", fs::perms(0644));
        run("rawlog2kitti", {"-i", out / "d.rawlog", "-o", out / "back"});
        fs::remove(out / "d.times.txt");
        run("scans2rawlog", {"-i", out / "d.rawlog", "-o", out / "e.rawlog", "--embed"});
        run("synth2rawlog", {"-o", out / "s.rawlog", "--scene", "urban", "--scans", "1",
                             "--distort", "--labels", "--sensor", "vlp16"});
        for (const char* name : {"m.pcd", "m.3Dscene", "m.gridmap", "n.yaml", "m.html"})
            run("delio-map", {"-i", map, "-o", out / name, "--frame", "ground"});
        run("delio-snapshot", {"-i", map, "-o", out / "m.png", "--size", "32x32"});
        run("delio-eval", {"--ref", seq_ / "poses.txt", "--est", seq_ / "poses.txt", "-o",
                           out / "report", "--lengths", "1"});
        for (const auto& entry : fs::recursive_directory_iterator(out)) {
            const auto full = entry.is_directory() ? fs::perms(0777) : fs::perms(0666);
            EXPECT_EQ(entry.status().permissions(), full & ~fs::perms(mask)) << entry;
        }
    }
}

TEST_F(ConvertersOutput, AFullDiskLeavesTheOldOnes) {
    fs::remove_all(seq_);
    test::writeSequence(seq_, {test::fewPoints(1), test::fewPoints(2, 300)});
    const std::string map = writeMap();
    ASSERT_EQ(toRawlog({"--count", "1"}).exitCode, 0);
    ASSERT_EQ(toKitti(folder_ / "back").exitCode, 0);
    const fs::path whole = folder_ / "whole.rawlog";
    ASSERT_EQ(test::runTool("kitti2rawlog", {"-i", seq_, "-o", whole}).exitCode, 0);
    for (const std::string name : {"m.pcd", "m.pcd.frame.yaml", "m.html", "n.yaml", "n.pgm"})
        test::writeText(folder_ / "out" / name, "old");
    const auto before = test::stateOf(folder_.path());
    const auto expectNothing = [&](const std::string& tool, Words words, const std::string& name) {
        words.emplace_back("--force");
        test::expectFailure(test::runToolOnFullDisk(tool, words, 1024), 1, {"cannot write", name});
        EXPECT_TRUE(test::stateOf(folder_.path()) == before) << tool;
        EXPECT_FALSE(test::hasLeftovers(folder_.path())) << tool;
    };
    expectNothing("kitti2rawlog", {"-i", seq_, "-o", rawlog_}, "d.rawlog");
    expectNothing("kitti2rawlog", {"-i", seq_, "-o", rawlog_, "--embed"}, "d.rawlog");
    expectNothing("scans2rawlog", {"-i", seq_, "-o", rawlog_}, "d.rawlog");
    expectNothing("synth2rawlog",
                  {"-o", rawlog_, "--scene", "urban", "--scans", "1", "--sensor", "vlp16"},
                  "d.rawlog");
    expectNothing("rawlog2kitti", {"-i", whole, "-o", folder_ / "back"}, "velodyne/000001.bin");
    for (const std::string name : {"m.pcd", "m.html", "n.yaml"})
        expectNothing("delio-map",
                      {"-i", map, "-o", folder_ / "out" / name, "--frame", "ground",
                       name == "n.yaml" ? "--height" : "--spacing", name == "n.yaml" ? "3" : "0"},
                      name == "n.yaml" ? "n.pgm" : name);
}
}  // namespace
