// Our files in MRPT's programs, and what they make of them in ours: the rows of
// share/doc/compatibility.md.
#include <gtest/gtest.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CRawlog.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>
#include <unistd.h>

#include <filesystem>
#include <set>

#include "command.h"
#include "test_data.h"
#include "toy_drive.h"
#include "virtual_display.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;
using test::runTool;

constexpr std::size_t kScans = 4;

/** A short drive as rawlog, and its trajectory by delio-slam. */
class Compatibility : public testing::Test {
 protected:
    Compatibility() {
        test::writeSequence(folder_ / "toy", test::toyScans(kScans));
        convert("drive.rawlog", {});
        trajectory_ = trajectoryOf("drive.rawlog");
        EXPECT_NE(trajectory_, "");
    }
    std::string at(const std::string& name) const { return folder_ / name; }

    void convert(const std::string& name, std::vector<std::string> more) const {
        more.insert(more.end(), {"-i", at("toy"), "-o", at(name)});
        const auto result = runTool("kitti2rawlog", more);
        EXPECT_EQ(result.exitCode, 0) << result.err;
    }
    /** Runs delio-slam; its trajectory_kitti.txt, or nothing. What lies beside a rawlog (times,
     *  sensor) does not travel through other programs, so it is left out everywhere. */
    std::string trajectoryOf(const std::string& name, std::vector<std::string> more = {}) const {
        fs::remove(at("drive.meta.yaml"));
        fs::remove(at("embedded.meta.yaml"));
        const std::string out = at("out-" + name);
        more.insert(more.end(), {"-i", at(name), "-o", out, "--no-map", "--force"});
        const auto result = runTool("delio-slam", more);
        EXPECT_EQ(result.exitCode, 0) << name << result.err;
        return result.exitCode == 0 ? test::readText(out + "/trajectory_kitti.txt") : "";
    }
    /** In the folder of the rawlogs: MRPT 2.5.8 does not find external files by a path. */
    test::CommandResult edit(const std::string& words) const {
        auto result =
            runTool("sh", {"-c", "cd '" + folder_.path().string() + "' && rawlog-edit " + words});
        EXPECT_EQ(result.exitCode, 0) << words << result.out << result.err;
        return result;
    }

    test::TemporaryFolder folder_;
    std::string trajectory_;
};

TEST_F(Compatibility, RawlogEditReadsOurRawlogs) {
    DELIO_NEED_PROGRAMS("rawlog-edit")
    const auto info = edit("--info -i drive.rawlog");
    EXPECT_NE(info.out.find("Overall number of objects         : 4"), std::string::npos)
        << info.out;
    EXPECT_NE(info.out.find("velodyne /      4"), std::string::npos) << info.out;
    const auto description = edit("--describe -i drive.rawlog");
    EXPECT_NE(description.out.find("CObservationPointCloud"), std::string::npos);
}

TEST_F(Compatibility, WeReadWhatRawlogEditMakes) {
    DELIO_NEED_PROGRAMS("rawlog-edit")
    edit("--de-externalize -i drive.rawlog -o whole.rawlog");
    EXPECT_EQ(trajectoryOf("whole.rawlog"), trajectory_);
    convert("embedded.rawlog", {"--embed"});
    edit("--externalize -i embedded.rawlog -o outside.rawlog");
    EXPECT_EQ(trajectoryOf("outside.rawlog"), trajectory_);
    // A cut rawlog still names the files of the whole one.
    edit("--cut --from-index 0 --to-index 2 -i drive.rawlog -o cut.rawlog");
    const auto cut = trajectoryOf("cut.rawlog", {"--images", at("drive_Images")});
    EXPECT_EQ(trajectory_.substr(0, cut.size()), cut);
    EXPECT_EQ(test::linesOf(cut).size(), kScans - 1);
}

TEST_F(Compatibility, SensoryFramesAreReadAsObservationsAre) {
    mrpt::obs::CRawlog rawlog;
    ASSERT_TRUE(rawlog.loadFromRawLogFile(at("drive.rawlog")));
    {
        mrpt::io::CFileOutputStream out(at("frames.rawlog"));
        auto archive = mrpt::serialization::archiveFrom(out);
        for (std::size_t i = 0; i < rawlog.size(); ++i) {
            mrpt::obs::CSensoryFrame frame;
            frame.insert(rawlog.getAsObservation(i));
            archive << mrpt::obs::CActionCollection() << frame;
        }
    }
    EXPECT_EQ(trajectoryOf("frames.rawlog", {"--images", at("drive_Images")}), trajectory_);
}

TEST_F(Compatibility, SceneViewerOpensTheScene) {
    DELIO_NEED_PROGRAMS("SceneViewer3D")
    const std::string out = at("with-map");
    ASSERT_EQ(runTool("delio-slam", {"-i", at("drive.rawlog"), "-o", out}).exitCode, 0);
    test::VirtualDisplay display;
    display.start("SceneViewer3D", {out + "/map.3Dscene"});
    EXPECT_TRUE(display.waitFor("[map.3Dscene]"));
    std::set<int> hues;  // colours of the map and its legend, three bits a channel
    for (int attempt = 0; attempt < 20 && hues.size() < 20; ++attempt) {
        usleep(500000);
        const auto image = display.screenshot();
        for (unsigned y = 0; y < image.getHeight(); ++y)
            for (unsigned x = 0; x < image.getWidth(); ++x) {
                const auto* p = image.ptr<std::uint8_t>(x, y);
                hues.insert(p[0] / 32 * 64 + p[1] / 32 * 8 + p[2] / 32);
            }
    }
    EXPECT_GE(hues.size(), 20U);
    EXPECT_EQ(display.windows().size(), 1U) << "a dialog";
    if (const char* folder = std::getenv("DELIO_PICTURES"))
        display.screenshot().saveToFile(std::string(folder) + "/SceneViewer3D.png");
}

TEST_F(Compatibility, TheLiveViewChangesNothingAndEndsCleanly) {
    DELIO_NEED_PROGRAMS("Xvfb")
    const std::string out = at("live");
    const std::vector<std::string> words = {"-i",       at("drive.rawlog"), "-o",   out,
                                            "--no-map", "--force",          "--gui"};
    unsetenv("DISPLAY");
    const auto blind = runTool("delio-slam", words);
    EXPECT_EQ(blind.exitCode, 1);
    EXPECT_FALSE(fs::exists(out));
    if (blind.err.find("libmrpt-gui-dev") != std::string::npos)
        GTEST_SKIP() << "built without mrpt-gui";
    EXPECT_NE(blind.err.find("display"), std::string::npos) << blind.err;
    const test::VirtualDisplay display;
    const auto shown = runTool("delio-slam", words, "close the window to end");
    EXPECT_EQ(shown.exitCode, 0) << shown.err;
    EXPECT_EQ(test::readText(out + "/trajectory_kitti.txt"), trajectory_);
}
}  // namespace
