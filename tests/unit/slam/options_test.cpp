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

/** `section.key = value` of every assignment, in their order; the plainest reading. */
std::vector<std::string> assignmentsOf(const std::string& text) {
    std::istringstream in(text);
    std::vector<std::string> assignments;
    std::string section;
    for (std::string line; std::getline(in, line);) {
        if (line.empty() || line[0] == '#') continue;
        if (line[0] == '[')
            section = line.substr(1, line.find(']') - 1) + ".";
        else
            assignments.push_back(section + line);
    }
    return assignments;
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

/** The defaults of either odometry. */
Options ofMethod(const std::string& method) {
    Options options;
    options.method.method = method;
    return options;
}

TEST(Profile, NamesAreThoseOfTheFiles) {
    std::set<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(delio::test::profileFolder()))
        if (entry.path().extension() == ".ini") files.insert(entry.path().stem().string());
    const auto names = Options::profileNames();
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()), files);
    EXPECT_TRUE(files.count("accurate"));
    EXPECT_TRUE(files.count("paper"));
    EXPECT_TRUE(files.count("paper-literal"));
    const auto fault = faultOf([](Options&) { Options::ofProfile("papre"); });
    EXPECT_TRUE(contains(fault, "'papre'"));
    EXPECT_TRUE(contains(fault, "paper, paper-extended, paper-literal"));
}

TEST(Profile, EachLoadsChecksAndIsWrittenAsTextThatLoadsToTheSame) {
    for (const auto& name : Options::profileNames()) {
        const Options options = Options::ofProfile(name);
        EXPECT_NO_THROW(options.check()) << name;
        EXPECT_NO_THROW(makeOdometry(options)) << name;
        Options again;
        again.load(textOf(options));
        EXPECT_NO_THROW(again.check()) << name;
        EXPECT_EQ(textOf(again), textOf(options)) << name;
        Options fromFile;
        fromFile.load(profileText(name));
        EXPECT_EQ(textOf(fromFile), textOf(options)) << name;
    }
}

TEST(Profile, TheDefaultsAreTheProfileAccurate) {
    EXPECT_EQ(textOf(Options{}), textOf(Options::ofProfile("accurate")));
    EXPECT_FALSE(Options{}.isPaper());
    EXPECT_TRUE(Options::ofProfile("paper").isPaper());
    EXPECT_TRUE(Options::ofProfile("paper-literal").isPaper());
    EXPECT_NE(textOf(Options::ofProfile("paper")), textOf(ofMethod("paper")));
    EXPECT_NE(textOf(Options::ofProfile("paper-literal")), textOf(Options::ofProfile("paper")));
}

TEST(Profile, OnlyPaperExtendedHasGuardsAndNoPaperClosesLoops) {
    for (const std::string name : {"paper", "paper-extended", "paper-literal"}) {
        const Options options = Options::ofProfile(name);
        EXPECT_EQ(options.paper.guarded(), name == "paper-extended") << name;
        EXPECT_FALSE(options.loops.enabled) << name;
        EXPECT_FALSE(options.map.removal.enabled) << name;
    }
}

TEST(Profile, EachHoldsNothingButWhatDiffersFromTheDefaults) {
    for (const auto& name : Options::profileNames()) {
        const Options options = Options::ofProfile(name);
        const auto defaults = assignmentsOf(textOf(ofMethod(options.method.method)));
        const auto written = assignmentsOf(textOf(options));
        for (const auto& assignment : assignmentsOf(profileText(name))) {
            EXPECT_EQ(std::count(written.begin(), written.end(), assignment), 1)
                << name << ": " << assignment;
            if (assignment != "odometry.method = paper") {
                EXPECT_EQ(std::count(defaults.begin(), defaults.end(), assignment), 0)
                    << name << ": " << assignment;
            }
        }
    }
}

TEST(Profile, EveryKeyIsWrittenUnderAComment) {
    for (const auto& name : Options::profileNames()) {
        std::istringstream in(textOf(Options::ofProfile(name)));
        std::size_t keys = 0;
        for (std::string line, above; std::getline(in, line); above = line)
            if (line.find('=') != line.npos && line[0] != '#') {
                ++keys;
                EXPECT_GT(above.size(), 10U) << name << ": " << line;
                EXPECT_EQ(above[0], '#') << name << ": " << line;
            }
        EXPECT_GT(keys, 40U);
    }
}

TEST(Options, TextThatMrptCannotReadIsRefusedInOneLine) {
    try {
        Options().load("# as $env{HOME\n[scan]\nmax_range = 80\n");
        FAIL() << "was read";
    } catch (const delio::Error& e) {
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    }
}

TEST(Profile, ADriveTellsItsCorrectionAndWhetherItIsSkewed) {
    for (const std::string method : {"planes", "paper"}) {
        delio::io::DriveMeta meta;
        meta.verticalCorrectionDeg = 0.205;
        Options options = ofMethod(method);
        options.adaptTo(meta);
        // The paper takes the points as they are.
        EXPECT_EQ(options.scan().vertical_correction_deg, method == "paper" ? 0 : 0.205);
        EXPECT_FALSE(options.scan().deskew);
        meta.motionCompensated = false;
        options.adaptTo(meta);
        EXPECT_TRUE(options.scan().deskew);
        EXPECT_EQ(options.scan().sweep_s, 0);
        meta.source = "kitti-raw";
        options.adaptTo(meta);
        EXPECT_EQ(options.scan().sweep_s, 0.1);
    }
}

TEST(Profile, ForADriveItIsAdaptedToTheDrive) {
    delio::io::DriveMeta meta;
    meta.source = "kitti-raw";
    meta.motionCompensated = false;
    meta.verticalCorrectionDeg = 0.205;
    for (const auto& name : Options::profileNames()) {
        Options adapted = Options::ofProfile(name);
        adapted.adaptTo(meta);
        EXPECT_EQ(textOf(Options::forDrive(name, meta)), textOf(adapted)) << name;
        EXPECT_NE(textOf(adapted), textOf(Options::ofProfile(name))) << name;
        EXPECT_EQ(textOf(Options::forDrive(name, {})), textOf(Options::ofProfile(name))) << name;
    }
}

TEST(Profile, WrittenAndLoadedOptionsGiveTheSameBytes) {
    for (const std::string profile : {"paper-literal", "accurate"}) {
        Options options = Options::ofProfile(profile);
        options.paper.pointMap.spacing = options.planes.pointMap.spacing = 1.0 / 3;
        options.paper.scan.vertical_correction_deg = options.planes.scan.vertical_correction_deg =
            0.205;
        options.planes.tracker.lost_share = 0.1 + 0.2;
        options.graph.kernel_width = 1e-17;
        options.map.voxelSize_m = 0.1;
        const auto text = textOf(options);
        Options again;
        again.load(text);
        EXPECT_EQ(textOf(again), text);
        EXPECT_EQ(again.isPaper(), profile != "accurate");
        const auto& pointMap = again.isPaper() ? again.paper.pointMap : again.planes.pointMap;
        EXPECT_EQ(pointMap.spacing, 1.0 / 3);
        EXPECT_EQ(again.scan().vertical_correction_deg, 0.205);
        EXPECT_EQ(again.graph.kernel_width, 1e-17);
        EXPECT_EQ(again.paper.lineRegistration.centroids, again.isPaper());
        EXPECT_EQ(again.planes.tracker.lost_share == 0.1 + 0.2, !again.isPaper());
    }
}

TEST(Profile, LoadRefusesWhatItDoesNotUnderstand) {
    EXPECT_TRUE(contains(loadFault("[scan]\nmin_range = 3\nmin_range 3\n"), "line 3"));
    EXPECT_TRUE(contains(loadFault("[scan]\n\n# fine\nrubbish\n"), "line 4: 'rubbish'"));
    EXPECT_TRUE(contains(loadFault("min_range = 3\n[scan]\n"), "line 1: 'min_range = 3'"));
    EXPECT_TRUE(contains(loadFault("[scan\nmin_range = 3\n"), "line 1"));
    EXPECT_TRUE(contains(loadFault("[scna]\nmin_range = 3\n"), "[scna]"));
    EXPECT_TRUE(contains(loadFault("[plane_tracker]\nenabled = true\n"), "plane_tracker.enabled"));
    EXPECT_TRUE(contains(loadFault("[mean_shift]\nbandwith = 1\n"), "mean_shift.bandwith"));
    EXPECT_TRUE(contains(loadFault("[odometry]\nmethod = icp\n"), "odometry.method: 'icp'"));
    EXPECT_TRUE(contains(loadFault("[scan]\nmin_rnage = 3\n"), "scan.min_rnage"));
    EXPECT_TRUE(contains(loadFault("[scan]\nmin_range = 3m\n"), "scan.min_range"));
    EXPECT_TRUE(contains(loadFault("[scan]\n= 3\n"), "line 2"));
    EXPECT_TRUE(contains(loadFault("[ ]\nmin_range = 3\n"), "does not exist"));
    EXPECT_TRUE(contains(loadFault(std::string("\0\x01\xff[scan]\n", 10)), "line 1"));
}

TEST(Profile, LoadTakesWindowsLineEndsIndentsAndComments) {
    Options options;
    options.load("; one\r\n\r\n[scan]\r\n  # two\r\n  min_range = 3\r\n\t\r\n[map]\r\n");
    EXPECT_EQ(options.planes.scan.min_range, 3);
    EXPECT_EQ(options.paper.scan.min_range, 3);  // a section that both odometries have
    EXPECT_EQ(options.planes.scan.max_range, Options{}.planes.scan.max_range);
    options.load("");
    EXPECT_EQ(options.planes.scan.min_range, 3);
}

TEST(Profile, SetTakesOneAssignment) {
    Options options;
    options.set("line_registration.centroids=true");
    EXPECT_TRUE(options.paper.lineRegistration.centroids);
    options.set("scan.vertical_correction_deg=-0.5");
    EXPECT_EQ(options.scan().vertical_correction_deg, -0.5);
    options.set("graph.skip_edges = 4");
    EXPECT_EQ(options.graph.skip_edges, 4U);
    options.set("odometry.method=paper");
    EXPECT_TRUE(options.isPaper());
    EXPECT_EQ(options.scan().vertical_correction_deg, -0.5);
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
                             "plane_tracker.enabled=true",
                             "odometry.method=icp",
                             "odometry.method=",
                             "scan.min_range=3\nmax_range=x"}) {
        Options options;
        EXPECT_THROW(options.set(text), delio::Error) << text;
        EXPECT_EQ(textOf(options), before) << text;
        options.method.method = "paper";
        EXPECT_EQ(textOf(options), textOf(ofMethod("paper"))) << text;
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

TEST(MapOptions, FollowTheSizeOfThePlaceWhereTheyAreNotSet) {
    const auto scaled = Options().map.atScale(0.25);
    EXPECT_EQ(scaled.voxelSize_m, 0.05);
    EXPECT_EQ(scaled.minRange_m, 0.625);
    EXPECT_EQ(scaled.maxRange_m, Options().map.maxRange_m);
    Options loaded, assigned;
    loaded.load("[map]\nvoxel_size = 0.2\n");  // the same as by default, but asked for
    assigned.map.minRange_m = 2;
    EXPECT_EQ(loaded.map.atScale(0.25).voxelSize_m, 0.2);
    EXPECT_EQ(loaded.map.atScale(0.25).minRange_m, 0.625);
    EXPECT_EQ(assigned.map.atScale(0.25).minRange_m, 2);
    EXPECT_EQ(assigned.map.atScale(0.25).voxelSize_m, 0.05);
}
}  // namespace
