// From GNSS fixes in a recording to a map and a trajectory on the earth.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "command.h"
#include "delio/core/text.h"
#include "delio/formats/georeference.h"
#include "delio/map/cloud_files.h"
#include "delio/places/stored_map.h"
#include "delio/run/run_folder.h"
#include "test_data.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/** The truth that synth2rawlog writes: the georeference of the map. */
earth::Georeference truthIn(const std::string& file) {
    std::istringstream text(test::readText(file));
    std::string line;
    earth::Georeference truth;
    std::getline(text, line);
    auto numbers = numbersIn(line.substr(line.rfind("height") + 6));
    truth.origin = {numbers.at(0), numbers.at(1), numbers.at(2)};
    std::getline(text, line);
    numbers = numbersIn(line.substr(line.rfind("map") + 3));
    for (int i = 0; i < 12; ++i)
        truth.enuFromMap.matrix()(i / 4, i % 4) = numbers.at(static_cast<std::size_t>(i));
    return truth;
}

class OnEarth : public testing::Test {
 protected:
    std::string at(const std::string& name) const { return folder_ / name; }

    void drive(const Words& more = {}) const {
        Words words{"-o",      at("d.rawlog"), "--scene", "urban", "--sensor", "vlp16",
                    "--scans", "60",           "--seed",  "11",    "--start",  "moving"};
        words.insert(words.end(), more.begin(), more.end());
        const auto made = test::runTool("synth2rawlog", words);
        ASSERT_EQ(made.exitCode, 0) << made.err;
    }

    test::CommandResult slam(const std::string& out, const Words& more = {}) const {
        Words words{"-i", at("d.rawlog"), "-o", at(out)};
        words.insert(words.end(), more.begin(), more.end());
        return test::runTool("delio-slam", words);
    }

    test::TemporaryFolder folder_;
};

TEST_F(OnEarth, ADriveWithFixesIsGeoreferenced) {
    drive({"--gnss", "0.02", "--gnss-jumps", "0.2"});
    const auto result = slam("out");
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_NE(result.out.find("georeference"), std::string::npos);
    const run::RunFolder out(at("out"));
    const auto place = io::readGeoreference(out.path(run::RunFolder::kGeoreference));
    const auto truth = truthIn(at("d.gnss.csv"));
    const earth::EnuFrame enu(truth.origin);
    for (const auto& pose : out.trajectory().poses) {
        const auto there = enu.enuOf(place.geodeticOf(pose.translation()));
        EXPECT_LT((there - truth.enuFromMap * pose.translation()).norm(), 0.2);
    }
    EXPECT_LT(
        std::abs(std::remainder(
            earth::heading_deg(place.enuFromMap) - earth::heading_deg(truth.enuFromMap), 360)),
        0.3);
    const auto summary = out.summary();
    const auto figure = [&](const std::string& name) {
        for (const auto& [key, value] : summary.georeference)
            if (key == name) return value;
        return std::nan("");
    };
    EXPECT_GT(figure("fixes"), 20);
    EXPECT_LT(figure("heading_sigma_deg"), 1);
    EXPECT_EQ(figure("latitude_deg"), place.origin.latitude_deg);
    const std::string csv = test::readText(out.path(run::RunFolder::kGeoTrajectory));
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 61);
    EXPECT_EQ(csv.substr(0, 16), "stamp_s,latitude");
    EXPECT_TRUE(out.has(run::RunFolder::kEnuTum));
    EXPECT_NE(test::readText(out.path(run::RunFolder::kGeoJson)).find("LineString"),
              std::string::npos);
}

TEST_F(OnEarth, TheMapIsInUtm) {
    drive({"--gnss", "0.02"});
    const auto result = slam("out");
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const run::RunFolder out(at("out"));
    const auto place = io::readGeoreference(out.path(run::RunFolder::kGeoreference));
    const auto las = test::runTool("delio-map", {"-i", at("out"), "-o", at("map.las")});
    ASSERT_EQ(las.exitCode, 0) << las.err;
    const auto map = map::loadLas(at("map.las"));
    earth::UtmZone zone;
    ASSERT_TRUE(earth::zoneIn(map.wkt, zone));
    EXPECT_EQ(zone.name(), "32N");
    const auto first = earth::utmOf(place.origin, zone);
    Eigen::AlignedBox3d box;
    for (const auto& point : map.points)
        box.extend(Eigen::Vector3d(point.position.cast<double>() + map.offset));
    EXPECT_TRUE(box.contains(first - Eigen::Vector3d(0, 0, 1)));
    EXPECT_LT(box.sizes().x(), 500);
    EXPECT_TRUE(fs::exists(at("map.las.frame.yaml")));
    const auto enuMap =
        test::runTool("delio-map", {"-i", at("out"), "-o", at("enu.ply"), "--frame", "enu"});
    EXPECT_EQ(enuMap.exitCode, 0) << enuMap.err;
    const auto again = test::runTool("delio-map", {"-i", at("map.las"), "-o", at("again.las")});
    EXPECT_EQ(again.exitCode, 0) << again.err;
    const auto same = map::loadLas(at("again.las"));
    ASSERT_EQ(same.points.size(), map.points.size());
    EXPECT_EQ(same.wkt, map.wkt);
    EXPECT_LT((same.points[5].position - map.points[5].position).norm(), 1e-3);

    // The stored map keeps it, and a drive that is localised there has it, too.
    const StoredMap stored(out.path(run::RunFolder::kStoredMap));
    ASSERT_TRUE(stored.georeference());
    EXPECT_TRUE(stored.georeference()->enuFromMap.matrix() == place.enuFromMap.matrix());
    const auto local = slam("local", {"--map", at("out"), "--no-gnss"});
    ASSERT_EQ(local.exitCode, 0) << local.err;
    EXPECT_TRUE(run::RunFolder(at("local")).has(run::RunFolder::kGeoTrajectory));
}

TEST_F(OnEarth, WithoutFixesNothingChanges) {
    drive({"--gnss", "2"});
    ASSERT_EQ(slam("without", {"--no-gnss"}).exitCode, 0);
    EXPECT_FALSE(fs::exists(at("without/georeference.yaml")));
    EXPECT_EQ(
        test::runTool("delio-map", {"-i", at("without"), "-o", at("map.ply"), "--frame", "utm"})
            .exitCode,
        1);
    // Their times say nothing: the drive is as good as without them.
    test::writeText(at("other.csv"), "time,latitude,longitude,height\n100,49,8.4,115\n");
    const auto other = slam("other", {"--gnss", at("other.csv")});
    EXPECT_EQ(other.exitCode, 0);
    EXPECT_NE(other.err.find("not georeferenced"), std::string::npos);
    EXPECT_NE(other.err.find("another clock"), std::string::npos);
    for (const char* name : {run::RunFolder::kTrajectory, run::RunFolder::kPly,
                             run::RunFolder::kStoredMap, run::RunFolder::kGraph})
        EXPECT_TRUE(test::readText(at("other/" + std::string(name))) ==
                    test::readText(at("without/" + std::string(name))))
            << name;
    test::writeText(at("bad.csv"), "time,latitude\n");
    EXPECT_EQ(slam("bad", {"--gnss", at("bad.csv")}).exitCode, 1);
    EXPECT_EQ(slam("missing", {"--gnss", at("missing.csv")}).exitCode, 1);
    EXPECT_FALSE(fs::exists(at("missing"))) << "refused after the drive";
    EXPECT_EQ(slam("bad", {"--no-gnss", "--gnss", at("bad.csv")}).exitCode, 2);
    EXPECT_EQ(slam("bad", {"--antenna", "1,2"}).exitCode, 2);
}

/** A line of control points for a point of the map, `off` metres east of its true place. */
std::string controlLine(const std::string& name, const Eigen::Vector3d& inMap,
                        const earth::Georeference& truth, double off, bool isUsed) {
    const auto place = earth::EnuFrame(truth.origin)
                           .geodeticOf(truth.enuFromMap * inMap + Eigen::Vector3d(off, 0, 0));
    std::string line = name;
    for (const double value :
         {inMap.x(), inMap.y(), inMap.z(), place.latitude_deg, place.longitude_deg, place.height_m})
        line += "," + rounded(value, 17);
    return line + (isUsed ? ",1\n" : ",0\n");
}

/** A map, and control points of it. */
class Control : public OnEarth {
 protected:
    void SetUp() override {
        drive();
        ASSERT_EQ(slam("out").exitCode, 0);
        truth.origin = {49.011, 8.4228, 112.8};
        truth.enuFromMap = Eigen::Translation3d(3, -4, 1.5) *
                           Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.02, -0.01, 1).normalized());
    }

    test::CommandResult map(const std::string& out, const std::string& points,
                            const Words& more = {}) const {
        Words words{"-i", at("out"), "-o", at(out), "--control", at(points)};
        words.insert(words.end(), more.begin(), more.end());
        return test::runTool("delio-map", words);
    }

    earth::Georeference truth;
    const std::string header = "name,x,y,z,latitude,longitude,height,use\n";
    const Eigen::Vector3d a{2, 20, -1.7}, b{40, -12, 3}, c{80, 15, 0.5}, d{55, 2, -1};
};

TEST_F(Control, PlacesAndChecksTheMap) {
    const std::string three = controlLine("a", a, truth, 0, true) +
                              controlLine("b", b, truth, 0, true) +
                              controlLine("c", c, truth, 0, true);
    test::writeText(at("points.csv"), header + three + controlLine("d", d, truth, 0.25, false));
    const auto result = map("map.las", "points.csv");
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_NE(result.err.find("3 used, RMS 0.000 m horizontally, 0.000 m in height; 1 checked, RMS "
                              "0.250 m horizontally, 0.000 m in height"),
              std::string::npos)
        << result.err;
    EXPECT_EQ(test::readText(at("map.las.control.csv")),
              "name,used,east_error_m,north_error_m,up_error_m\na,1,0.0000,0.0000,0.0000\n"
              "b,1,0.0000,0.0000,0.0000\nc,1,0.0000,0.0000,0.0000\nd,0,-0.2500,0.0000,0.0000\n");
    const auto las = map::loadLas(at("map.las"));
    earth::UtmZone zone;
    ASSERT_TRUE(earth::zoneIn(las.wkt, zone));
    const auto plain = test::runTool("delio-map", {"-i", at("out"), "-o", at("plain.las")});
    ASSERT_EQ(plain.exitCode, 0) << plain.err;
    const auto inMap = map::loadLas(at("plain.las"));
    ASSERT_EQ(inMap.points.size(), las.points.size());
    for (std::size_t i = 0; i < las.points.size(); i += 1000) {
        const auto there =
            earth::utmOf(truth.geodeticOf(inMap.points[i].position.cast<double>()), zone);
        EXPECT_LT((las.points[i].position.cast<double>() + las.offset - there).norm(), 0.01);
    }
}

TEST_F(Control, InUtmAndAllUsed) {
    const earth::UtmZone zone{32, true};
    std::string utm = "x;y;z;easting;northing;height;zone\n";
    for (const auto& p : {a, b, c, d}) {
        const auto there = earth::utmOf(truth.geodeticOf(p), zone);
        for (const double value : {p.x(), p.y(), p.z(), there.x(), there.y(), there.z()})
            utm += rounded(value, 17) + ";";
        utm += "32N\n";
    }
    test::writeText(at("utm.csv"), utm);
    const auto byUtm = map("utm.las", "utm.csv");
    EXPECT_NE(byUtm.err.find("4 used, RMS 0.000 m"), std::string::npos) << byUtm.err;
}

TEST_F(Control, RefusesBadPoints) {
    const auto refused = [&](const std::string& text, const std::string& why) {
        test::writeText(at("bad.csv"), text);
        const auto bad = map("bad.las", "bad.csv");
        EXPECT_EQ(bad.exitCode, 1);
        EXPECT_NE(bad.err.find(why), std::string::npos) << bad.err;
        EXPECT_FALSE(fs::exists(at("bad.las")));
    };
    refused("name,x,y\n", "line 1");
    refused(header, "no control points");
    refused(header + "a,1,2,3,95,8,100,1\n", "line 2: the place is not on the earth");
    refused(header + "a,1,2,nan,49,8,100,1\n", "line 2: z is missing or not a number");
    refused(header + "a,1,2,3,49,8,100,yes\n", "line 2: use must be 0 or 1");
    refused(header + controlLine("a", a, truth, 0, true) + controlLine("b", b, truth, 0, true),
            "at least three");
    refused(header + controlLine("a", a, truth, 0, true) + controlLine("b", b, truth, 0, true) +
                controlLine("c", 2 * b - a, truth, 0, true),
            "on one line");
    refused(header + controlLine("a", a, truth, 0, true) + controlLine("b", b, truth, 80, true) +
                controlLine("c", c, truth, 0, true),
            "does not fit");
    refused(header + controlLine("a", a, truth, 0, false), "not georeferenced");
    EXPECT_EQ(map("bad.las", "bad.csv", {"--georeference", "1,2,3,4"}).exitCode, 2);
}
}  // namespace
