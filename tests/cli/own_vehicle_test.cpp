// Points of the own vehicle: left out as told by --vehicle-box, or found.
#include <gtest/gtest.h>

#include <string>

#include "delio/recordings/rawlog_reader.h"
#include "delio/run/run_folder.h"
#include "delio_slam_fixture.h"

namespace {
using namespace delio;
using test::readText;
using test::runTool;
using test::Words;
using test::writeText;
using test::operator+;
namespace fs = std::filesystem;

class OwnVehicleFile : public test::DelioSlam {
 protected:
    std::string trajectoryOf(const fs::path& input, const std::string& name,
                             const Words& more = {}) const {
        const auto run =
            runTool("delio-slam", Words{"-i", input, "-o", folder_ / name, "--no-map"} + more);
        EXPECT_EQ(run.exitCode, 0) << run.err;
        return readText(folder_ / name / "trajectory_kitti.txt");
    }
    std::size_t pointsOf(const std::string& rawlog) const {
        return io::RawlogReader(rawlog).next()->points->size();
    }
    test::CommandResult convert(const std::string& to, const std::string& box) const {
        return runTool("scans2rawlog", {"-i", rawlog_, "-o", to, "--vehicle-box", box});
    }
    const std::string mask_ = folder_ / "mask.txt";
};

TEST_F(OwnVehicleFile, HoldsForScans2rawlogAndDelioSlam) {
    writeDrive();
    const std::string box = "-8,-2,-2,-3,2,1", boxed = folder_ / "boxed.rawlog",
                      masked = folder_ / "masked.rawlog";
    writeText(mask_, "# a trailer\nbox -8 -2 -2 -3 2 1\nsector 150 -150 -30 30 9 # and its tail\n");
    ASSERT_EQ(convert(boxed, box).exitCode, 0);
    ASSERT_EQ(convert(masked, mask_).exitCode, 0);
    EXPECT_LT(pointsOf(boxed), pointsOf(rawlog_));
    EXPECT_LT(pointsOf(masked), pointsOf(boxed));
    EXPECT_GT(pointsOf(masked), 0U);
    EXPECT_TRUE(trajectoryOf(masked, "converted") ==
                trajectoryOf(rawlog_, "masked", {"--vehicle-box", mask_}));
    writeText(mask_, "box -8 -2 -2 -3 2 1\n");
    EXPECT_TRUE(trajectoryOf(rawlog_, "file", {"--vehicle-box", mask_}) ==
                trajectoryOf(rawlog_, "numbers", {"--vehicle-box", box}));
}

TEST_F(OwnVehicleFile, ABadOneIsRefusedWithItsLine) {
    writeDrive();
    const std::string made = folder_ / "made.rawlog";
    writeText(mask_, "box -8 -2 -2 -3 2 1\nsector 150 -150 -30\n");
    expectRefused(slam({"--vehicle-box", mask_}), 2, {"mask.txt', line 2: expected sector"});
    expectFailure(convert(made, mask_), 2, {"mask.txt', line 2: expected sector"});
    writeText(mask_, "\n\nbox -8 -2 -1 -3 2\n");
    expectRefused(slam({"--vehicle-box", mask_}), 2, {"mask.txt', line 3: expected box"});
    for (const std::string text : {"1,2,3", "no-such-file"})
        expectRefused(slam({"--vehicle-box", text}), 2, {"--vehicle-box needs", text});
    EXPECT_FALSE(fs::exists(made));
    writeText(mask_, "sector 0 1 80 81\n");
    const auto run = slam({"--vehicle-box", mask_});
    EXPECT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NE(run.err.find("no point of any scan lies in"), std::string::npos) << run.err;
}

/** A VLP-16 before a trailer. */
TEST_F(OwnVehicleFile, ATrailerIsFoundAndDoesNoHarm) {
    const std::string trailer = "-7,-1.2,-1.5,-4,1.2,0.8";
    ASSERT_EQ(runTool("synth2rawlog",
                      {"-o", rawlog_, "--scene", "urban", "--sensor", "vlp16", "--scans", "110",
                       "--seed", "54583", "--start", "moving", "--distort", "--own-box", trailer})
                  .exitCode,
              0);
    const auto errorOf = [&](const std::string& name) {
        for (const auto& [metric, value] : run::RunFolder(folder_ / name).summary().metrics)
            if (metric == "end_error_percent") return value;
        return 100.0;
    };
    trajectoryOf(rawlog_, "found");
    trajectoryOf(rawlog_, "given", {"--vehicle-box", "-7.1,-1.3,-1.6,-3.8,1.3,0.9"});
    const double found = errorOf("found"), given = errorOf("given");
    RecordProperty("found", std::to_string(found));
    RecordProperty("given", std::to_string(given));
    EXPECT_LT(found, 1.5 * given + 0.05);
    const auto own = run::RunFolder(folder_ / "found").summary().own_vehicle;
    ASSERT_EQ(own.size(), 6U);
    EXPECT_TRUE(run::RunFolder(folder_ / "given").summary().own_vehicle.empty());
    const auto expectBad = [&](const std::string& box) {
        expectFailure(runTool("synth2rawlog", {"-o", folder_ / "bad.rawlog", "--scene", "urban",
                                               "--scans", "2", "--own-box", box}),
                      2, {"--own-box needs XMIN"});
    };
    expectBad("1,2,3");
    expectBad("1,0,0,0,1,1");
}
}  // namespace
