#include "delio/slam/options.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>
#include <sstream>

#include "delio/core/error.h"
#include "test_data.h"

namespace {
using delio::Options;

std::string textOf(const Options& options) {
    std::ostringstream out;
    options.write(out);
    return out.str();
}

std::string profileText(const std::string& name) {
    return delio::test::readText(delio::test::profileFolder() / (name + ".ini"));
}

/** section.key of every assignment, in their order; the plainest reading. */
std::vector<std::string> keysOf(const std::string& text) {
    std::istringstream in(text);
    std::vector<std::string> keys;
    std::string section;
    for (std::string line; std::getline(in, line);) {
        if (line.empty() || line[0] == '#') continue;
        if (line[0] == '[')
            section = line.substr(1, line.find(']') - 1) + ".";
        else
            keys.push_back(section + line.substr(0, line.find(' ')));
    }
    return keys;
}

std::string faultOf(const std::function<void(Options&)>& act) {
    Options options;
    try {
        act(options);
    } catch (const delio::Error& e) {
        return e.what();
    }
    return "";
}

std::string loadFault(const std::string& text) {
    return faultOf([&](Options& options) { options.load(text); });
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != text.npos;
}

TEST(Profile, NamesAreThoseOfTheFiles) {
    std::set<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(delio::test::profileFolder()))
        if (entry.path().extension() == ".ini") files.insert(entry.path().stem().string());
    const auto names = Options::profileNames();
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()), files);
    EXPECT_TRUE(files.count("paper"));
    EXPECT_TRUE(files.count("paper-literal"));
    const auto fault = faultOf([](Options&) { Options::ofProfile("papre"); });
    EXPECT_TRUE(contains(fault, "'papre'"));
    EXPECT_TRUE(contains(fault, "paper, paper-literal"));
}

/** What follows from the drive. */
const std::set<std::string> kOfTheDrive = {"scan.vertical_correction_deg", "scan.deskew",
                                           "scan.sweep_s"};

TEST(Profile, EveryFileNamesEveryOptionOnceButWhatFollowsFromTheDrive) {
    for (const auto& name : Options::profileNames()) {
        auto written = keysOf(textOf(Options::ofProfile(name)));
        const auto end = std::remove_if(written.begin(), written.end(),
                                        [](const auto& key) { return kOfTheDrive.count(key) > 0; });
        EXPECT_EQ(written.end() - end, 3);
        written.erase(end, written.end());
        EXPECT_EQ(keysOf(profileText(name)), written) << name;
    }
}

TEST(Profile, ADriveTellsItsCorrectionAndWhetherItIsSkewed) {
    delio::io::DriveMeta meta;
    meta.verticalCorrectionDeg = 0.205;
    Options options;
    options.adaptTo(meta);
    EXPECT_EQ(options.odometry.preprocess.vertical_correction_deg, 0.205);
    EXPECT_FALSE(options.odometry.preprocess.deskew);
    meta.motionCompensated = false;
    options.adaptTo(meta);
    EXPECT_TRUE(options.odometry.preprocess.deskew);
    EXPECT_EQ(options.odometry.preprocess.sweep_s, 0);
    meta.source = "kitti-raw";
    options.adaptTo(meta);
    EXPECT_EQ(options.odometry.preprocess.sweep_s, 0.1);
}

TEST(Profile, EveryKeyOfAFileHasACommentAbove) {
    for (const auto& name : Options::profileNames()) {
        std::istringstream in(profileText(name));
        for (std::string line, above; std::getline(in, line); above = line)
            if (line.find('=') != line.npos && line[0] != '#') {
                EXPECT_GT(above.size(), 10U) << name << ": " << line;
                EXPECT_EQ(above[0], '#') << name << ": " << line;
            }
    }
}

// The same meanings, values and digits as delio-slam writes into config.ini.
TEST(Profile, FilesReadAsTheyAreWritten) {
    for (const auto& name : Options::profileNames()) {
        std::istringstream in(textOf(Options::ofProfile(name)));
        const auto file = profileText(name);
        for (std::string line, section; std::getline(in, line);) {
            if (line[0] == '[') section = line.substr(1, line.find(']') - 1) + ".";
            const auto isOfTheDrive = [&](const std::string& text) {
                return kOfTheDrive.count(section + text.substr(0, text.find(' '))) > 0;
            };
            std::string next;  // of a comment: the key below it
            if (line[0] == '#') {
                const auto here = in.tellg();
                std::getline(in, next);
                in.seekg(here);
            }
            EXPECT_TRUE(isOfTheDrive(line) || isOfTheDrive(next) ||
                        contains("\n" + file, "\n" + line + "\n"))
                << name << ": " << line;
        }
    }
}

TEST(Profile, PaperIsWhatTheStructsStartFrom) {
    EXPECT_EQ(textOf(Options::ofProfile("paper")), textOf(Options{}));
    EXPECT_NE(textOf(Options::ofProfile("paper-literal")), textOf(Options{}));
}

TEST(Profile, WrittenAndLoadedOptionsGiveTheSameBytes) {
    Options options = Options::ofProfile("paper-literal");
    options.odometry.normals.voxel_size = 1.0 / 3;
    options.odometry.preprocess.vertical_correction_deg = 0.205;
    options.graph.kernel_width = 1e-17;
    options.map.voxelSize_m = 0.1;
    const auto text = textOf(options);
    Options again;
    again.load(text);
    EXPECT_EQ(textOf(again), text);
    EXPECT_EQ(again.odometry.normals.voxel_size, 1.0 / 3);
    EXPECT_EQ(again.odometry.preprocess.vertical_correction_deg, 0.205);
    EXPECT_EQ(again.graph.kernel_width, 1e-17);
    EXPECT_TRUE(again.odometry.lineRegistration.centroids);
}

TEST(Profile, LoadRefusesWhatItDoesNotUnderstand) {
    EXPECT_TRUE(contains(loadFault("[scan]\nmin_range = 3\nmin_range 3\n"), "line 3"));
    EXPECT_TRUE(contains(loadFault("[scan]\n\n# fine\nrubbish\n"), "line 4: 'rubbish'"));
    EXPECT_TRUE(contains(loadFault("min_range = 3\n[scan]\n"), "line 1: 'min_range = 3'"));
    EXPECT_TRUE(contains(loadFault("[scan\nmin_range = 3\n"), "line 1"));
    EXPECT_TRUE(contains(loadFault("[scna]\nmin_range = 3\n"), "[scna]"));
    EXPECT_TRUE(contains(loadFault("[scan]\nmin_rnage = 3\n"), "scan.min_rnage"));
    EXPECT_TRUE(contains(loadFault("[scan]\nmin_range = 3m\n"), "scan.min_range"));
    EXPECT_TRUE(contains(loadFault("[scan]\n= 3\n"), "line 2"));
    EXPECT_TRUE(contains(loadFault("[ ]\nmin_range = 3\n"), "does not exist"));
    EXPECT_TRUE(contains(loadFault(std::string("\0\x01\xff[scan]\n", 10)), "line 1"));
}

TEST(Profile, LoadTakesWindowsLineEndsIndentsAndComments) {
    Options options;
    options.load("; one\r\n\r\n[scan]\r\n  # two\r\n  min_range = 3\r\n\t\r\n[map]\r\n");
    EXPECT_EQ(options.odometry.preprocess.min_range, 3);
    EXPECT_EQ(options.odometry.preprocess.max_range, 80);
    options.load("");
    EXPECT_EQ(options.odometry.preprocess.min_range, 3);
}

TEST(Profile, SetTakesOneAssignment) {
    Options options;
    options.set("line_registration.centroids=true");
    EXPECT_TRUE(options.odometry.lineRegistration.centroids);
    options.set("scan.vertical_correction_deg=-0.5");
    EXPECT_EQ(options.odometry.preprocess.vertical_correction_deg, -0.5);
    options.set("graph.skip_edges = 4");
    EXPECT_EQ(options.graph.skip_edges, 4U);
}

TEST(Profile, SetRefusesEverythingElse) {
    const auto before = textOf(Options{});
    for (const char* text : {"",
                             "scan",
                             "scan.min_range",
                             "min_range=3",
                             "=3",
                             ".",
                             ".=",
                             "scan=a.b",
                             "scan.=5",
                             ".min_range=5",
                             "scan.#min_range=5",
                             "scan.;min_range=5",
                             "scan.[map]=5",
                             "scan.min_range=",
                             "scan.min_range=abc",
                             "scan.min_range=-1",
                             "scan.min_range=1=2",
                             "scna.min_range=3",
                             "scan.min_rnage=3",
                             "scan.min_range=3\nmax_range=x"}) {
        Options options;
        EXPECT_THROW(options.set(text), delio::Error) << text;
        EXPECT_EQ(textOf(options), before) << text;
    }
    const auto fault = faultOf([](Options& options) { options.set("scan.min_range=1.5x"); });
    EXPECT_TRUE(contains(fault, "scan.min_range")) << fault;
    EXPECT_TRUE(contains(fault, "'1.5x'")) << fault;
}

TEST(Profile, SetsTellsWhatATextSets) {
    const std::string text = "[scan]\n# vertical_correction_deg = 1\nmin_range = 3\n[map]\n";
    EXPECT_TRUE(Options::sets(text, "scan", "min_range"));
    EXPECT_FALSE(Options::sets(text, "scan", "vertical_correction_deg"));
    EXPECT_FALSE(Options::sets(text, "map", "min_range"));
    EXPECT_FALSE(Options::sets(text, "graph", "min_range"));
    EXPECT_FALSE(Options::sets("", "scan", "min_range"));
}
}  // namespace
