#include <cmath>

#include "delio/formats/trajectory.h"
#include "delio/run/run_folder.h"
#include "delio_slam_fixture.h"
#include "poses.h"

// Stored maps: --map, --extend, several drives.
namespace {
using namespace delio;
using test::linesOf;
using test::readText;
using test::Words;
using test::operator+;
namespace fs = std::filesystem;

/** A street that is driven along, later by others in the other lane, and another street. */
class StoredMaps : public testing::Test {
 protected:
    static void SetUpTestSuite() { folder_ = new test::TemporaryFolder; }
    static void TearDownTestSuite() { delete folder_; }

    static std::string path(const std::string& name) { return *folder_ / name; }
    /** Made when it is needed first. */
    static std::string drive(const std::string& name) {
        std::string rawlog = path(name + ".rawlog");
        if (fs::exists(rawlog)) return rawlog;
        Words words{"-o",       rawlog,  "--scene", "urban",
                    "--sensor", "vlp16", "--scans", "130",
                    "--movers", "4",     "--seed",  name == "elsewhere" ? "12" : "4"};
        if (name == "back") words = words + Words{"--drive-seed", "8", "--reverse"};
        const auto made = test::runTool("synth2rawlog", words);
        EXPECT_EQ(made.exitCode, 0) << made.err;
        return rawlog;
    }
    /** The folder of the first drive's map. */
    static std::string old() {
        std::string folder = path("old");
        if (fs::exists(folder)) return folder;
        const auto run =
            test::runTool("delio-slam", {"-i", drive("first"), "-o", folder, "--count", "75"});
        EXPECT_EQ(run.exitCode, 0) << run.err;
        return folder;
    }

    static test::CommandResult localise(const std::string& name, const std::string& out,
                                        const Words& more = {}) {
        return test::runTool(
            "delio-slam",
            Words{"-i", drive(name), "-o", path(out), "--map", old(), "--force"} + more);
    }
    /** Of a drive's vehicle in the frame of the first one's first scan. */
    static std::vector<Eigen::Isometry3d> truth(const std::string& name) {
        const auto origin = [&](const std::string& of) {
            drive(of);
            return io::readTrajectory(path(of + ".origin.txt")).poses.front();
        };
        drive(name);
        const auto Tr = io::readCalibration(path(name + ".calib.txt")).Tr;
        auto poses = io::readTrajectory(path(name + ".poses.txt")).poses;
        for (auto& pose : poses)
            pose = Tr.inverse() * origin("first").inverse() * origin(name) * pose * Tr;
        return poses;
    }
    /** Where a map has what is truly there, by the nearest pose that the first drive gave it: a map
     *  is bent by the drift of its own drive, and turned by that of its first scan. */
    static std::vector<Eigen::Isometry3d> inMap(const std::vector<Eigen::Isometry3d>& there,
                                                const StoredMap& map) {
        const auto known = truth("first");
        const auto mapped = map.trajectory(map.drives()[0]).poses;
        std::vector<Eigen::Isometry3d> poses;
        for (const auto& pose : there) {
            std::size_t nearest = 0;
            for (std::size_t i = 0; i < mapped.size(); ++i)
                if (test::metresBetween(known[i], pose) < test::metresBetween(known[nearest], pose))
                    nearest = i;
            poses.push_back(mapped[nearest] * known[nearest].inverse() * pose);
        }
        return poses;
    }
    static run::RunFolder results(const std::string& out) { return run::RunFolder(path(out)); }
    static std::string oldMap() { return readText(fs::path(old()) / "map.delio"); }

    static test::TemporaryFolder* folder_;
};
test::TemporaryFolder* StoredMaps::folder_ = nullptr;

TEST_F(StoredMaps, ADriveIsLocalisedInTheMapsFrame) {
    const std::string before = oldMap();
    const auto run = localise("back", "in", {"--no-map", "--threads", "2"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NE(run.out.find("in the stored map"), std::string::npos) << run.out;
    const auto where = results("in").localisation();
    const auto poses = results("in").trajectory().poses,
               wanted = inMap(truth("back"), run::RunFolder(old()).storedMap());
    ASSERT_EQ(where.size(), wanted.size());
    ASSERT_EQ(poses.size(), wanted.size());
    std::size_t inMap = 0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        inMap += where[i].where == Whereabouts::kInMap;
        EXPECT_LT(test::metresBetween(poses[i], wanted[i]), where[i].measured ? 0.05 : 0.1) << i;
    }
    EXPECT_GT(inMap, 50U);
    EXPECT_EQ(results("in").summary().in_map, inMap);
    EXPECT_EQ(results("in").odometry().poses.front().matrix(), Eigen::Matrix4d::Identity());
    EXPECT_FALSE(results("in").has(run::RunFolder::kStoredMap));
    EXPECT_TRUE(oldMap() == before);

    // The same bytes by one thread.
    ASSERT_EQ(localise("back", "one", {"--no-map", "--threads", "1"}).exitCode, 0);
    for (const char* name : {"localisation.csv", "trajectory_kitti.txt", "posegraph.g2o"})
        EXPECT_TRUE(readText(fs::path(path("in")) / name) == readText(fs::path(path("one")) / name))
            << name;

    const auto eval =
        test::runTool("delio-eval", {"--ref", path("in") + "/trajectory_kitti.txt", "--est",
                                     path("one") + "/trajectory_kitti.txt", "--same-frame"});
    ASSERT_EQ(eval.exitCode, 0) << eval.err;
    EXPECT_NE(eval.out.find("unaligned difference to the reference: median 0.0000 m, 0.0000 deg"),
              std::string::npos)
        << eval.out;
}

TEST_F(StoredMaps, TheGraphIsListedAndEdited) {
    const auto map = [](const Words& words, int exitCode, const std::string& text = "") {
        const auto run = test::runTool("delio-map", words + Words{"--force"});
        EXPECT_EQ(run.exitCode, exitCode) << run.err;
        EXPECT_NE(run.err.find(text), std::string::npos) << run.err;
    };
    test::writeText(path("add.txt"), "add 0 1  # neighbours\n");
    test::writeText(path("forbid.txt"), "forbid 1 0\n");
    map({"-i", old(), "-o", path("edited.delio"), "--edits", path("add.txt")}, 0);
    map({"-i", path("edited.delio"), "-o", path("edges.csv")}, 0);
    EXPECT_EQ(linesOf(readText(path("edges.csv"))).size(), 2U);
    map({"-i", path("edited.delio"), "-o", path("back.delio"), "--edits", path("forbid.txt")}, 0);
    map({"-i", path("back.delio"), "-o", path("edges.csv")}, 0);
    EXPECT_EQ(linesOf(readText(path("edges.csv"))).size(), 1U);
    map({"-i", old(), "-o", path("no.delio"), "--edits", path("forbid.txt")}, 1, "no edge");
    map({"-i", old(), "-o", path("no.delio"), "--edits", path("none.txt")}, 1, "none.txt");
    map({"-i", old(), "-o", path("no.ply"), "--edits", path("add.txt")}, 2, "OUT.delio");
    map({"-i", old(), "-o", path("no.csv"), "--frame", "ground"}, 2, "--frame has no effect");
    EXPECT_FALSE(fs::exists(path("no.delio")));
}

TEST_F(StoredMaps, WhoSaysWhereItIsIsFoundThere) {
    const auto start = truth("first")[20];
    const std::string near = std::to_string(start(0, 3) + 1) + "," + std::to_string(start(1, 3)) +
                             ",0," +
                             std::to_string(std::atan2(start(1, 0), start(0, 0)) * 180 / M_PI);
    const auto run = localise(
        "first", "near", {"--no-map", "--start", "20", "--count", "8", "--initial-pose", near});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    const auto wanted = inMap({truth("first")[27]}, run::RunFolder(old()).storedMap());
    EXPECT_LT(test::metresBetween(results("near").trajectory().poses.back(), wanted[0]), 0.05);
}

TEST_F(StoredMaps, WhatIsNotThereIsNotFound) {
    const auto run = localise("elsewhere", "not", {"--no-map"});
    EXPECT_EQ(run.exitCode, 1);
    EXPECT_NE(run.err.find("no scan of the drive could be localised in the map"), std::string::npos)
        << run.err;
    EXPECT_EQ(results("not").summary().in_map, 0U);
    EXPECT_EQ(results("not").trajectory().poses.size(), 130U);  // the odometry's own
}

TEST_F(StoredMaps, WhatIsNewIsAddedAndTheOldMapStays) {
    const std::string before = oldMap();
    const auto run = localise("back", "more", {"--extend"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NE(run.out.find("stored map extended"), std::string::npos) << run.out;
    EXPECT_TRUE(oldMap() == before);
    const auto more = results("more").storedMap(), less = run::RunFolder(old()).storedMap();
    EXPECT_GT(more.submaps().size(), less.submaps().size());
    ASSERT_EQ(more.drives().size(), 2U);
    EXPECT_EQ(more.drives()[1].name, "back");
    const auto wanted = inMap(truth("back"), more);
    const auto poses = more.trajectory(more.drives()[1]).poses;
    for (std::size_t i = 0; i < poses.size(); ++i)
        EXPECT_LT(test::metresBetween(poses[i], wanted[i]), 0.1) << i;
    EXPECT_FALSE(results("more").joints().empty());

    // The end of the first drive is in the map now.
    const auto again =
        test::runTool("delio-slam", {"-i", drive("first"), "-o", path("end"), "--start", "95",
                                     "--no-map", "--map", path("more") + "/map.delio"});
    ASSERT_EQ(again.exitCode, 0) << again.err;
    const auto wantedEnd = inMap({wanted.front(), truth("first").back()}, less);
    EXPECT_LT(test::metresBetween(results("end").trajectory().poses.back(), wantedEnd.back()), 0.1);
    const auto picture = test::runTool("delio-snapshot", {"-i", path("more") + "/map.delio", "-o",
                                                          path("more.png"), "--size", "320x240"});
    EXPECT_EQ(picture.exitCode, 0) << picture.err;
    EXPECT_GT(fs::file_size(path("more.png")), 10000U);
}

TEST_F(StoredMaps, DrivesAreJoinedWhereTheyMeet) {
    const auto run =
        test::runTool("delio-slam", {"-i", drive("first"), "-i", drive("elsewhere"), "-i",
                                     drive("back"), "-o", path("joined"), "--count", "90"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    const fs::path out = path("joined");
    EXPECT_EQ(linesOf(readText(out / "drives.csv")),
              (Words{"map,drive", "map.delio,first", "map.delio,back", "map-2.delio,elsewhere"}));
    EXPECT_NE(run.err.find("not all drives overlap: 2 separate maps"), std::string::npos)
        << run.err;
    for (const std::string name : {"first", "back"}) {
        const auto poses = io::readTrajectory(out / (name + "_kitti.txt")).poses;
        const auto wanted = inMap(truth(name), StoredMap((out / "map.delio").string()));
        ASSERT_EQ(poses.size(), 90U);
        for (std::size_t i = 0; i < poses.size(); ++i)
            EXPECT_LT(test::metresBetween(poses[i], wanted[i]), 0.1) << name << i;
        EXPECT_EQ(io::readTrajectory(out / (name + "_tum.txt")).stamps_s.size(), 90U);
    }
    EXPECT_EQ(StoredMap((out / "map.delio").string()).drives().size(), 2U);
    EXPECT_TRUE(fs::exists(out / "back" / "map.ply"));
}

TEST_F(StoredMaps, BadMapsAreRefusedInOneLine) {
    const fs::path bad = path("bad.delio");
    const std::string whole = oldMap();
    std::string other = whole;
    other[8] = 9;
    const auto refused = [&](const std::string& bytes, const std::string& word) {
        test::writeText(bad, bytes);
        const auto run =
            test::runTool("delio-slam", {"-i", drive("back"), "-o", path("refused"), "--map", bad});
        test::expectFailure(run, 1, {bad.string(), word});
    };
    refused(whole.substr(0, whole.size() / 2), "cut off");
    refused(other, "version 9");
    refused("", "not a stored map");
    refused("solid", "not a stored map");
    test::expectFailure(test::runTool("delio-slam", {"-i", drive("back"), "-o", path("refused"),
                                                     "--map", path("none")}),
                        1, {"none"});
    fs::create_directory(path("empty"));
    test::expectFailure(test::runTool("delio-slam", {"-i", drive("back"), "-o", path("refused"),
                                                     "--map", path("empty")}),
                        1, {"empty", "map.delio"});
    // Nothing that is read is overwritten.
    test::expectFailure(
        test::runTool("delio-slam", {"-i", drive("back"), "-o", old(), "--map", old(), "--force"}),
        1, {"overwrite the map"});
    EXPECT_TRUE(oldMap() == whole);
}

TEST_F(StoredMaps, ContradictionsAreABadCommandLine) {
    const auto refused = [&](const Words& words, const std::string& word) {
        test::expectFailure(
            test::runTool("delio-slam",
                          Words{"-i", path("back.rawlog"), "-o", path("refused")} + words),
            2, {word});
    };
    refused({"--extend"}, "--map");
    refused({"--initial-pose", "1,2,3,4"}, "--map");
    refused({"--map", path("old"), "--initial-pose", "1,2,3"}, "X,Y,Z,YAW_DEG");
    refused({"--map", path("old"), "--initial-pose", "1,2,3,x"}, "X,Y,Z,YAW_DEG");
    refused({"--map", path("old"), "--extend", "--no-map"}, "--no-map");
    refused({"-i", path("first.rawlog"), "--map", path("old")}, "--extend");
    refused({"-i", path("first.rawlog"), "--no-map"}, "--no-map");
    refused({"-i", path("first.rawlog"), "--images", path("x")}, "--images");
    const auto twins = test::runTool(
        "delio-slam", {"-i", drive("back"), "-i", drive("back"), "-o", path("refused")});
    test::expectFailure(twins, 1, {"two drives have the same name, 'back'"});
}

TEST_F(StoredMaps, AFullDiskLeavesTheOldMapAndNoHalfOne) {
    const std::string before = oldMap();
    const auto run = test::runToolOnFullDisk(
        "delio-slam",
        {"-i", drive("back"), "-o", path("full"), "--map", old(), "--extend", "--force"}, 262144);
    EXPECT_EQ(run.exitCode, 1);
    EXPECT_TRUE(oldMap() == before);
    for (const auto& name : test::namesIn(path("full")))
        EXPECT_EQ(name.find("partial"), std::string::npos) << name;
    const fs::path half = fs::path(path("full")) / "map.delio";
    if (fs::exists(half)) {
        EXPECT_NO_THROW(StoredMap(half.string()));
    }
}
}  // namespace
