// kitti2rawlog on KITTI's odometry layout, and bad inputs.
#include <string>
#include <vector>

#include "delio/formats/trajectory.h"
#include "delio/recordings/rawlog_reader.h"
#include "kitti_tools.h"
#include "same_scans.h"

namespace {
using namespace delio;
using test::fewPoints;
using test::fewScans;
using test::KittiTools;
using test::runTool;
using test::Words;
using test::writeText;
namespace fs = std::filesystem;

TEST_F(KittiTools, SideFilesHoldWhatWasThere) {
    ASSERT_EQ(toRawlog().exitCode, 0);
    for (const std::string name : {"calib.txt", "times.txt", "poses.txt"})
        EXPECT_EQ(test::readText(side("." + name)), test::readText(seq_ / name));
    const auto meta = io::readDriveMeta(rawlog_);
    ASSERT_TRUE(meta);
    EXPECT_EQ(meta->source, "kitti-odometry");
    EXPECT_EQ(meta->sensorModel, "HDL-64E");
    EXPECT_TRUE(meta->motionCompensated);
    EXPECT_EQ(meta->verticalCorrectionDeg, 0.205);
    EXPECT_EQ(test::namesIn(folder_ / "out").size(), 1U + 1 + 5 + 4);  // no .partial files
}

TEST_F(KittiTools, StartAndCountPickTheRows) {
    ASSERT_EQ(toRawlog({"--start", "2", "--count", "2"}).exitCode, 0);
    for (const std::string name : {"times.txt", "poses.txt"}) {
        const auto all = test::linesOf(test::readText(seq_ / name));
        EXPECT_EQ(test::linesOf(test::readText(side("." + name))), Words({all[2], all[3]}));
    }
    io::RawlogReader reader(rawlog_);
    for (const std::size_t scan : {2U, 3U}) {
        const auto found = reader.next();
        ASSERT_TRUE(found);
        EXPECT_NEAR(found->stamp_s, 0.1 * static_cast<double>(scan), 1e-7);
        EXPECT_EQ(found->points->getPointsBufferRef_x()[0], fewPoints(scan)[0]);
    }
    EXPECT_FALSE(reader.next());
    // More than there is: to the end.
    ASSERT_EQ(toRawlog({"--start", "4", "--count", "9", "--force"}).exitCode, 0);
    EXPECT_EQ(test::linesOf(test::readText(side(".times.txt"))).size(), 1U);
}

TEST_F(KittiTools, MissingPartsAreWarnings) {
    fs::remove(seq_ / "times.txt");
    fs::remove(seq_ / "poses.txt");
    writeText(seq_ / "calib.txt", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\n");
    const auto run = toRawlog();
    EXPECT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NE(run.err.find("warning: '" + (seq_ / "calib.txt").string() + "' has no Tr"),
              std::string::npos)
        << run.err;
    EXPECT_NE(run.err.find("assuming 0.1 s between scans"), std::string::npos) << run.err;
    EXPECT_FALSE(fs::exists(side(".poses.txt")));
    EXPECT_EQ(io::readTimes(side(".times.txt")), (std::vector<double>{0, 0.1, 0.2, 0.3, 0.4}));
    fs::remove(seq_ / "calib.txt");
    EXPECT_EQ(toRawlog({"--force"}).exitCode, 0);
    EXPECT_FALSE(fs::exists(side(".calib.txt")));
}

TEST_F(KittiTools, RefusesWhatIsNoSequence) {
    const fs::path missing = folder_ / "none";
    const auto convert = [&](const fs::path& in) {
        return runTool("kitti2rawlog", {"-i", in, "-o", rawlog_});
    };
    expectRefused(convert(missing), 1, {missing, "not a folder"});
    expectRefused(convert(seq_ / "times.txt"), 1, {"not a folder"});
    fs::create_directories(missing);
    expectRefused(convert(missing), 1, {missing, "velodyne/"});
    fs::create_directories(missing / "velodyne");
    expectRefused(convert(missing), 1, {"no .bin file"});
    writeText(missing / "velodyne" / "first.bin", "");
    expectRefused(convert(missing), 1, {"first.bin", "number"});
}

TEST_F(KittiTools, RefusesACutScan) {
    for (const char* bytes : {"123456789012345", "12345678901234567"}) {
        writeText(seq_ / "velodyne" / "000003.bin", bytes);
        expectRefused(toRawlog(), 1, {"000003.bin", "multiple of 16"});
        expectRefused(toRawlog({"--embed"}), 1, {"000003.bin", "multiple of 16"});
    }
    EXPECT_EQ(toRawlog({"--count", "3"}).exitCode, 0);
}

TEST_F(KittiTools, RefusesTooFewRows) {
    writeText(seq_ / "times.txt", "0\n0.1\n0.2\n");
    expectRefused(toRawlog(), 1, {"times.txt", "3 rows", "--count 3"});
    EXPECT_EQ(toRawlog({"--count", "3"}).exitCode, 0);
    writeText(seq_ / "times.txt", "0\n0.1\n0.2\n0.3\n0.4\n");
    const auto poses = test::linesOf(test::readText(seq_ / "poses.txt"));
    writeText(seq_ / "poses.txt", poses[0] + "\n" + poses[1] + "\n");
    test::expectFailure(toRawlog({"--force"}), 1, {"poses.txt", "2 rows", "--count 2"});
    const auto late = toRawlog({"--force", "--start", "3"});
    test::expectFailure(late, 1, {"poses.txt", "2 rows"});
    EXPECT_EQ(late.err.find("--count 0"), std::string::npos) << late.err;
    EXPECT_EQ(toRawlog({"--force", "--count", "2"}).exitCode, 0);
}

TEST_F(KittiTools, RefusesBrokenTexts) {
    const auto with = [&](const std::string& name, const std::string& text) {
        const std::string good = test::readText(seq_ / name);
        writeText(seq_ / name, text);
        const auto run = toRawlog();
        writeText(seq_ / name, good);
        return run;
    };
    expectRefused(with("times.txt", "0\n0.1\nnoon\n0.3\n0.4\n"), 1, {"times.txt', line 3", "noon"});
    expectRefused(with("times.txt", ""), 1, {"times.txt", "empty"});
    expectRefused(with("poses.txt", "1 0 0 0 0 1 0 0 0 0 1\n"), 1, {"poses.txt', line 1", "12"});
    expectRefused(with("calib.txt", "Tr: 1 2 3\n"), 1, {"calib.txt', line 1", "12 numbers"});
    EXPECT_EQ(toRawlog().exitCode, 0);
}

// A converter changes nothing; what reads the rawlog sorts the scans and says so.
TEST_F(KittiTools, KeepsTimesThatFall) {
    const std::string falling = "0\n0.2\n0.1\n0.3\n0.4\n";
    writeText(seq_ / "times.txt", falling);
    ASSERT_EQ(toRawlog().exitCode, 0);
    EXPECT_EQ(test::readText(side(".times.txt")), falling);
}

TEST_F(KittiTools, RefusesABadCommandLine) {
    expectRefused(toRawlog({"--start", "-1"}), 2, {"-1"});
    expectRefused(toRawlog({"--count", "-3"}), 2, {"-3"});
    expectRefused(toRawlog({"--count", "1.5"}), 2, {"1.5"});
    expectRefused(toRawlog({"--start", "two"}), 2, {"two"});
    expectRefused(toRawlog({"--every", "2"}), 2, {"every"});
    expectRefused(runTool("kitti2rawlog", {"-i", seq_}), 2, {"output"});
    expectRefused(runTool("rawlog2kitti", {"-o", "x"}), 2, {"input"});
    expectRefused(toRawlog({"--start", "5"}), 1, {"5 scans", "--start 5"});
}

TEST_F(KittiTools, RefusesAnOutputThatItCannotWrite) {
    const auto into = [&](const fs::path& out) {
        return runTool("kitti2rawlog", {"-i", seq_, "-o", out});
    };
    expectRefused(into(folder_ / "out" / "d.log"), 1, {".rawlog"});
    expectRefused(into("/proc/d.rawlog"), 1, {"/proc/d.rawlog"});
    expectRefused(into(seq_ / "times.txt" / "d.rawlog"), 1, {"times.txt/d.rawlog"});
    expectRefused(into(folder_ / "none" / "d.rawlog"), 1, {"none/d.rawlog"});
}

TEST_F(KittiTools, ReplacesOnlyWithForce) {
    ASSERT_EQ(toRawlog().exitCode, 0);
    writeText(side(".faults.tsv"), "of a synthetic drive\n");
    const auto before = test::namesIn(folder_ / "out");
    const std::string bytes = test::readText(rawlog_);
    test::expectFailure(toRawlog({"--count", "2"}), 1, {rawlog_, "--force"});
    EXPECT_EQ(test::namesIn(folder_ / "out"), before);
    EXPECT_EQ(test::readText(rawlog_), bytes);
    // A side file alone is reason enough.
    fs::remove(rawlog_);
    test::expectFailure(toRawlog(), 1, {"--force"});

    fs::remove(seq_ / "poses.txt");
    fs::remove(seq_ / "calib.txt");
    ASSERT_EQ(toRawlog({"--embed", "--force"}).exitCode, 0);
    EXPECT_EQ(test::namesIn(folder_ / "out"), Words({"d.meta.yaml", "d.rawlog", "d.times.txt"}));

    fs::remove(rawlog_);
    fs::create_directory(rawlog_);
    test::expectFailure(toRawlog({"--force"}), 1, {rawlog_, "is a folder"});
    EXPECT_TRUE(fs::exists(side(".times.txt")));
}

TEST_F(KittiTools, AnInterruptLeavesNothing) {
    for (std::size_t i = 5; i < 3000; ++i)
        test::writeFloats(seq_ / "velodyne" / test::scanName(i), fewPoints(i));
    for (const char* name : {"times.txt", "poses.txt"}) fs::remove(seq_ / name);
    const auto run = runTool("kitti2rawlog", {"-i", seq_, "-o", rawlog_}, "converting 300/3000");
    EXPECT_EQ(run.exitCode, 130) << run.err;
    EXPECT_EQ(test::namesIn(folder_ / "out"), Words());
}

TEST_F(KittiTools, LinksToTheScans) {
    const fs::path linked = folder_ / "out" / "linked.rawlog";
    const auto from = fs::relative(seq_);  // links hold the whole path all the same
    const auto run = runTool("kitti2rawlog", {"-i", from, "-o", linked, "--link"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    ASSERT_EQ(toRawlog().exitCode, 0);
    EXPECT_EQ(test::readText(linked), test::readText(rawlog_));
    const fs::path link = folder_ / "out" / "linked_Images" / "000003.bin";
    ASSERT_TRUE(fs::is_symlink(link));
    EXPECT_TRUE(fs::read_symlink(link).is_absolute());
    EXPECT_TRUE(fs::equivalent(link, seq_ / "velodyne" / "000003.bin"));
    io::RawlogReader copies(rawlog_), links(linked);
    EXPECT_EQ(test::expectSameScans(copies, links), 5U);
    test::expectSameDrive(copies, links);

    // What the links lead to stays when they are replaced.
    ASSERT_EQ(runTool("kitti2rawlog", {"-i", seq_, "-o", linked, "--force"}).exitCode, 0);
    EXPECT_FALSE(fs::is_symlink(link));
    EXPECT_EQ(test::namesIn(seq_ / "velodyne").size(), 5U);
}

TEST_F(KittiTools, RefusesToLinkWrongly) {
    expectRefused(toRawlog({"--link", "--embed"}), 2, {"--link", "--embed"});
    writeText(seq_ / "velodyne" / "000003.bin", "123456789012345");
    expectRefused(toRawlog({"--link"}), 1, {"000003.bin", "multiple of 16"});
}

TEST_F(KittiTools, FindsThePosesOfKittisOwnLayout) {
    const fs::path sequence = folder_ / "dataset" / "sequences" / "07";
    test::writeSequence(sequence, fewScans(3));
    fs::create_directory(folder_ / "dataset" / "poses");
    fs::rename(sequence / "poses.txt", folder_ / "dataset" / "poses" / "07.txt");
    const std::string poses = test::readText(folder_ / "dataset" / "poses" / "07.txt");
    for (const std::string name : {"", "/", "/.", "/../07/"}) {
        const auto run =
            runTool("kitti2rawlog", {"-i", sequence.string() + name, "-o", rawlog_, "--force"});
        ASSERT_EQ(run.exitCode, 0) << run.err;
        ASSERT_TRUE(fs::exists(side(".poses.txt"))) << name;
        EXPECT_EQ(test::readText(side(".poses.txt")), poses);
    }
}

TEST_F(KittiTools, RawlogEditCountsAllScans) {
    ASSERT_EQ(toRawlog({"--link"}).exitCode, 0);
    const auto info = runTool("rawlog-edit", {"--info", "-i", rawlog_});
    if (info.exitCode == 127) {
        if (test::dataIsRequired()) FAIL() << "rawlog-edit (mrpt-apps) is not installed";
        GTEST_SKIP() << "rawlog-edit (mrpt-apps) is not installed";
    }
    EXPECT_EQ(info.exitCode, 0) << info.err;
    EXPECT_NE(info.out.find("velodyne"), std::string::npos) << info.out;
    bool counted = false;
    for (const auto& line : test::linesOf(info.out))
        counted = counted || (line.find("velodyne") != std::string::npos &&
                              line.find("5") != std::string::npos);
    EXPECT_TRUE(counted) << info.out;
}
}  // namespace
