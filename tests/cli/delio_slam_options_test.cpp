// delio-slam: options, and bad command lines.
#include <gtest/gtest.h>

#include <sstream>

#include "delio/slam/options.h"
#include "delio_slam_fixture.h"

namespace {
using namespace delio;
using test::DelioSlam;
using test::linesOf;
using test::readText;
using test::runTool;
using test::Words;
using test::writeText;
using test::operator+;
namespace fs = std::filesystem;

TEST_F(DelioSlam, ABadCommandLineIsExit2) {
    writeDrive(1);
    expectRefused(slam({"--set", "graph.skip_edges=many"}), 2, {"graph.skip_edges", "many"});
    expectRefused(slam({"--set", "graph.skip_egdes=1"}), 2, {"graph.skip_egdes"});
    expectRefused(slam({"--set", "grahp.skip_edges=1"}), 2, {"grahp"});
    expectRefused(slam({"--set", "scan.max_range=nan"}), 2, {"scan.max_range"});
    expectRefused(slam({"--set", "skip_edges=1"}), 2, {"section.key=value"});
    expectRefused(slam({"--profile", "fast"}), 2, {"fast", "paper"});
    expectRefused(slam({"-c", folder_ / "none.ini"}), 2, {"none.ini"});
    expectRefused(slam({"-c", folder_.path()}), 2, {folder_.path()});
    const auto withConfig = [&](const std::string& text) {
        writeText(folder_ / "c.ini", text);
        return slam({"-c", folder_ / "c.ini"});
    };
    expectRefused(withConfig("[scan]\nmax_range = 1.5x\n"), 2, {"c.ini", "scan.max_range", "1.5x"});
    expectRefused(withConfig("[scan]\nmax_ragne = 15\n"), 2, {"scan.max_ragne"});
    expectRefused(withConfig("max_range = 15\n"), 2, {"line 1"});
    expectRefused(withConfig("[scan]\nmax_range 15\n"), 2, {"line 2"});
    expectRefused(slam({"--start", "-1"}), 2, {"-1"});
    expectRefused(slam({"--threads", "-1"}), 2, {"-1"});
    expectRefused(slam({"--threads", "4294967295"}), 2, {"--threads", "4096 or less"});
    expectRefused(slam({"--every", "0"}), 2, {"--every"});
    expectRefused(slam({"--count", "x"}), 2, {"x"});
    expectRefused(slam({"--ground-truth-frame", "imu"}), 2, {"imu"});
    expectRefused(slam({"--mapless"}), 2, {"mapless"});
    expectRefused(runTool("delio-slam", {"-o", out_}), 2, {"input"});
    EXPECT_EQ(withConfig("").exitCode, 0);
}

TEST_F(DelioSlam, OfAnOptionThatIsGivenAgainTheLastCounts) {
    writeDrive(4);
    const auto run = slam({"--no-map", "--every", "x", "--no-map", "--every=4", "--every", "2",
                           "--set", "graph.window=3", "--set", "graph.min_overlap=0.25"});
    EXPECT_EQ(run.exitCode, 0) << run.err;
    EXPECT_EQ(linesOf(readText(out_ / "scans.csv")).size(), 3U);  // with the names of the columns
    EXPECT_FALSE(fs::exists(out_ / "map.ply"));
    const std::string config = readText(out_ / "config.ini");
    EXPECT_NE(config.find("window = 3\n"), std::string::npos);
    EXPECT_NE(config.find("min_overlap = 0.25\n"), std::string::npos);
}

// An option that would do nothing is refused, by its section's name.
TEST_F(DelioSlam, OptionsOfTheOtherMethodAreExit2) {
    writeDrive(1);
    expectRefused(slam({"--set", "line_registration.search_radius=0"}), 2,
                  {"line_registration", "planes"});
    expectRefused(slam({"--profile", "paper", "--set", "plane_map.voxel_size=2"}), 2,
                  {"plane_map", "paper"});
    expectRefused(slam({"--set", "odometry.method=velas"}), 2, {"velas", "planes, paper"});
    writeText(folder_ / "c.ini", "[mean_shift]\n[odometry]\nmethod = planes\n");
    expectRefused(slam({"--profile", "paper", "-c", folder_ / "c.ini"}), 2, {"mean_shift"});
    EXPECT_EQ(slam({"--profile", "paper", "--set", "line_registration.search_radius=0"}).exitCode,
              0);
}

TEST_F(DelioSlam, ItsConfigHasTheSectionsInUseOnly) {
    writeDrive(1);
    const auto sections = [&](const std::string& profile) {
        EXPECT_EQ(slam({"--profile", profile, "--force"}).exitCode, 0);
        Words names;
        for (const auto& line : linesOf(readText(out_ / "config.ini")))
            if (!line.empty() && line[0] == '[') names.push_back(line);
        return names;
    };
    EXPECT_EQ(sections("accurate"),
              Words({"[odometry]", "[scan]", "[prediction]", "[plane_tracker]", "[point_map]",
                     "[point_registration]", "[plane_map]", "[plane_registration]",
                     "[moving_objects]", "[graph]", "[map]", "[removal]", "[submaps]", "[loops]",
                     "[closures]", "[place_search]", "[localisation]"}));
    EXPECT_EQ(sections("paper"), Words({"[odometry]",
                                        "[scan]",
                                        "[normals]",
                                        "[bilateral_filter]",
                                        "[outlier_removal]",
                                        "[mean_shift]",
                                        "[pattern_registration]",
                                        "[rotation_in_place]",
                                        "[line_cloud]",
                                        "[line_registration]",
                                        "[prediction]",
                                        "[point_check]",
                                        "[point_map]",
                                        "[point_registration]",
                                        "[graph]",
                                        "[map]",
                                        "[removal]",
                                        "[submaps]",
                                        "[loops]",
                                        "[closures]",
                                        "[place_search]",
                                        "[localisation]"}));
}

/** Every option of `ini` has its meaning in the line above it. Returns how many there are. */
std::size_t expectMeanings(const std::string& ini) {
    std::size_t options = 0;
    std::string before;
    for (const auto& line : linesOf(ini)) {
        const bool isOption = line.find(" = ") != std::string::npos && line[0] != '#';
        EXPECT_TRUE(isOption || line.empty() || line[0] == '[' || line[0] == '#') << line;
        if (isOption) {
            ++options;
            EXPECT_EQ(before.rfind("# ", 0), 0U) << line;
            EXPECT_GT(before.size(), 8U) << line;
        }
        before = line;
    }
    return options;
}

TEST(PrintConfig, PrintsEveryOptionOfEachProfileWithItsMeaning) {
    const test::TemporaryFolder folder;
    for (const auto& profile : Options::profileNames()) {
        const auto printed = runTool("delio-slam", {"--print-config", "--profile", profile});
        ASSERT_EQ(printed.exitCode, 0) << printed.err;
        EXPECT_EQ(printed.err, "");
        // What a drive says of itself is left to it: KITTI's vertical angles, for one.
        std::ostringstream whole;
        Options::ofProfile(profile).write(whole);
        std::string expected = whole.str();
        for (const std::string key : {"vertical_correction_deg", "deskew", "sweep_s"}) {
            // The paper takes the points as they are.
            if (profile != "accurate" && key == "vertical_correction_deg") continue;
            const auto at = expected.find("\n" + key + " = ");
            ASSERT_NE(at, std::string::npos) << key;
            expected.insert(at + 1, "# ");
        }
        // And those of the map that follow the size of the place.
        for (const std::string key : {"voxel_size", "min_range"}) {
            const auto at = expected.find("\n" + key + " = ", expected.find("\n[map]\n"));
            ASSERT_NE(at, std::string::npos) << key;
            expected.insert(at + 1, "# ");
        }
        EXPECT_EQ(printed.out, expected);
        EXPECT_GT(expectMeanings(printed.out), 40U) << profile;
        writeText(folder / "c.ini", printed.out);
        EXPECT_EQ(runTool("delio-slam", {"--print-config", "-c", folder / "c.ini"}).out,
                  printed.out);
    }
    EXPECT_EQ(runTool("delio-slam", {"--print-config"}).out,
              runTool("delio-slam", {"--print-config", "--profile", "accurate"}).out);
}

TEST(PrintConfig, TakesTheOptionsThatAreGiven) {
    const auto with = [](const Words& more) {
        return runTool("delio-slam", Words{"--print-config"} + more);
    };
    const auto set = with({"--set", "scan.max_range=42"});
    EXPECT_EQ(set.exitCode, 0) << set.err;
    EXPECT_NE(set.out.find("\nmax_range = 42\n"), std::string::npos) << set.out;
    EXPECT_NE(with({"--set", "scan.deskew=true"}).out.find("\ndeskew = true\n"), std::string::npos);
    const test::TemporaryFolder folder;
    writeText(folder / "c.ini", "\xEF\xBB\xBF[scan]\nmax_range = 42\n");  // of some editors
    EXPECT_EQ(with({"-c", folder / "c.ini"}).out, set.out);
    // Input and output may be named, and are left alone.
    const fs::path out = folder / "out";
    EXPECT_EQ(with({"-i", folder / "none.rawlog", "-o", out}).out, with({}).out);
    EXPECT_FALSE(fs::exists(out));
    for (const auto& wrong : {with({"--set", "scan.max_range=-1"}), with({"--profile", "fast"}),
                              with({"--set", "line_registration.search_radius=0"})}) {
        EXPECT_EQ(wrong.out, "");
        test::expectFailure(wrong, 2, {"delio-slam"});
    }
    const Words full{"-c", "\"$0\" --print-config > /dev/full", test::toolPath("delio-slam")};
    test::expectFailure(runTool("sh", full), 1, {"stdout"});
}
}  // namespace
