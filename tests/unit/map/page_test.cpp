#include "delio/map/page.h"

#include <gtest/gtest.h>
#include <mrpt/containers/yaml.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <random>

#include "delio/core/error.h"
#include "map/page_cloud.h"
#include "page_file.h"
#include "test_data.h"

namespace {
using namespace delio;
using map::MapPoint;
using map::MapPoints;
using map::PageCloud;
using map::PageContent;

/** Over `reach` metres of ground and 30 m of height, with everything known. */
MapPoints somePoints(std::size_t count, float reach = 300) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0, 1);
    MapPoints points(count);
    for (auto& point : points) {
        const float x = unit(random), y = unit(random), z = unit(random);
        point.position = {reach * (x - 0.5F), reach * (y - 0.5F), 30 * z};
        point.intensity = unit(random);
        point.time_s = 500 * unit(random);
        point.observations = static_cast<std::uint16_t>(400 * unit(random));
    }
    return points;
}

class Page : public testing::Test {
 protected:
    std::string textOf(const PageContent& content) const {
        map::savePage(content, folder_ / "map.html");
        return test::readText(folder_ / "map.html");
    }
    std::string messageOf(const PageContent& content, const std::string& threeJs) const {
        try {
            map::savePage(content, folder_ / "map.html", threeJs);
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    }

    test::TemporaryFolder folder_;
};

TEST_F(Page, HoldsEveryPointWithinItsQuantum) {
    PageContent content;
    content.points = somePoints(5000);
    const std::string page = textOf(content);
    const auto about =
        mrpt::containers::yaml::FromText(test::scriptOf(page, "about"));  // JSON is YAML
    EXPECT_EQ(about["points"]["shown"].as<int>(), 5000);
    EXPECT_EQ(about["points"]["total"].as<int>(), 5000);
    const auto places = test::numbersOf<std::uint16_t>(page, "places");
    const auto known = test::numbersOf<std::uint8_t>(page, "known");
    ASSERT_EQ(places.size(), 20000U);
    ASSERT_EQ(known.size(), 20000U);

    // Which point is which: every one is near one of the map's, and every one of the map's is met.
    const auto scales = map::pageScalesOf(content.points);
    std::vector<int> met(content.points.size());
    for (const auto& row : about["points"]["tiles"].asSequence()) {
        std::vector<double> tile;
        for (const auto& number : row.asSequence())
            tile.push_back(std::stod(number.as<std::string>()));
        ASSERT_EQ(tile.size(), 5U);
        for (auto i = static_cast<std::size_t>(tile[3]),
                  end = i + static_cast<std::size_t>(tile[4]);
             i < end; ++i) {
            const Eigen::Vector3d place(tile[0] + 0.001 * places[4 * i],
                                        tile[1] + 0.001 * places[4 * i + 1],
                                        tile[2] + 0.001 * places[4 * i + 2]);
            std::size_t nearest = 0;
            for (std::size_t k = 1; k < content.points.size(); ++k)
                if ((content.points[k].position.cast<double>() - place).norm() <
                    (content.points[nearest].position.cast<double>() - place).norm())
                    nearest = k;
            const MapPoint& point = content.points[nearest];
            ++met[nearest];
            EXPECT_LT((point.position.cast<double>() - place).cwiseAbs().maxCoeff(), 0.00051);
            const double time = (known[4 * i + 2] + 256 * known[4 * i + 3]) / 65535.0;
            EXPECT_NEAR(scales.time_s.low + time * (scales.time_s.high - scales.time_s.low),
                        point.time_s, 0.005);
            EXPECT_EQ(known[4 * i + 1], std::min<int>(point.observations, 255));
            EXPECT_NEAR(known[4 * i] / 255.0,
                        std::clamp(scales.intensity.fractionAt(point.intensity), 0.0, 1.0), 0.002);
        }
    }
    EXPECT_EQ(std::count(met.begin(), met.end(), 1), 5000);
}

TEST_F(Page, HasHeightsAboveTheGroundOnAHill) {
    PageContent content;
    for (int i = 0; i < 200; ++i)
        for (int k = -10; k <= 10; ++k) {
            MapPoint ground;
            ground.position = {0.5F * static_cast<float>(i), static_cast<float>(k),
                               0.05F * static_cast<float>(i)};
            content.points.push_back(ground);
            if (k != 3) continue;
            ground.position.z() += 4;
            content.points.push_back(ground);
        }
    const auto places = test::numbersOf<std::uint16_t>(textOf(content), "places");
    std::size_t low = 0, high = 0;
    for (std::size_t i = 3; i < places.size(); i += 4) {
        const double height = places[i] * PageCloud::kGroundQuantum_m + PageCloud::kLowestGround_m;
        low += height > -1.5 && height < 1.8;
        high += height > 2.5 && height < 5.8;
    }
    EXPECT_EQ(low, 200U * 21);
    EXPECT_EQ(high, 200U);
}

TEST_F(Page, TwoMillionPointsStayBelowFortyMegabytesAndMoreAreThinned) {
    PageContent content;
    content.points = somePoints(2500000, 1500);
    content.dynamic = somePoints(300000, 1500);
    content.trajectory = test::straightWay(5000);
    const std::string page = textOf(content);
    EXPECT_LT(page.size(), 40e6);
    EXPECT_NE(page.find("\"points\":{\"shown\":2000000,\"total\":2500000,"), std::string::npos);
    EXPECT_NE(page.find("\"dynamic\":{\"shown\":200000,\"total\":300000,"), std::string::npos);
    EXPECT_EQ(test::fromBase64(test::scriptOf(page, "places")).size(), 16000000U);
}

TEST_F(Page, ThinsEvenlyAndDropsWhatIsNowhere) {
    MapPoints points(1000);
    for (std::size_t i = 0; i < points.size(); ++i) points[i].position.x() = static_cast<float>(i);
    const auto few = map::thinned(points, 300);
    ASSERT_EQ(few.size(), 300U);
    for (std::size_t i = 1; i < few.size(); ++i) {
        const float apart = few[i].position.x() - few[i - 1].position.x();
        EXPECT_TRUE(apart == 3 || apart == 4) << apart;
    }
    points[5].position.y() = std::numeric_limits<float>::quiet_NaN();
    points[6].position.z() = std::numeric_limits<float>::infinity();
    points[7].position.x() = 1e30F;
    EXPECT_EQ(map::thinned(points, 5000).size(), 997U);
}

TEST_F(Page, TheFirstPointsOfATileAreAnEvenChoice) {
    MapPoints points(6000);
    for (std::size_t i = 0; i < points.size(); ++i)
        points[i].position.x() = 0.01F * static_cast<float>(i);  // within one tile
    const map::GroundHeight ground(0, [](std::size_t) { return Eigen::Vector3f(0, 0, 0); });
    const auto cloud = map::pageCloudOf(points, map::pageScalesOf(points), ground);
    ASSERT_EQ(cloud.tiles.size(), 1U);
    std::vector<int> counts(10);
    for (std::size_t i = 0; i < 600; ++i) ++counts.at(cloud.places[4 * i] / 6000U);
    for (const int count : counts) EXPECT_NEAR(count, 60, 3);
}

TEST_F(Page, TakesAnyTitleAndFetchesNothing) {
    PageContent content;
    content.points = somePoints(10);
    content.title = "</script><script>alert('1')</script> & \"q\" </title> {{about}}\n\x01";
    const std::string page = textOf(content);
    EXPECT_NE(page.find("<title>&lt;/script&gt;&lt;script&gt;alert('1')&lt;/script&gt; &amp; "
                        "&quot;q&quot; &lt;/title&gt; {{about}}?"
                        "?</title>"),
              std::string::npos);
    EXPECT_EQ(page.find("<script>alert"), std::string::npos);
    for (const char* link : {"src=\"", "href=\"", "url(", "<link", "@import", "<iframe", "<img"})
        EXPECT_EQ(page.find(link), std::string::npos) << link;
    EXPECT_NE(page.find("default-src 'none'"), std::string::npos);  // nor could it
    EXPECT_NE(page.find("THREE"), std::string::npos);
}

TEST_F(Page, HasTheSameBytesTwice) {
    PageContent content;
    content.points = somePoints(3000);
    content.dynamic = somePoints(30);
    content.trajectory = content.truth = test::straightWay(50);
    content.odometry = test::straightWay(50);
    content.loops = {{0, 49}};
    const std::string page = textOf(content);
    EXPECT_EQ(textOf(content), page);
    EXPECT_NE(page.find("\"loops\":[[0,49]]"), std::string::npos);
    EXPECT_NE(page.find("\"odometry\":[]"), std::string::npos);  // the same as the trajectory
    content.odometry.back().translation().y() += 0.5;
    EXPECT_NE(textOf(content).find("\"odometry\":[[0.000,0.000,0.000]"), std::string::npos);
}

TEST_F(Page, WhatIsNotKnownIsNotOffered) {
    PageContent content;
    content.points.resize(3);
    const std::string page = textOf(content);
    for (const char* name : {"\"intensity\":null", "\"time\":null", "\"observations\":null"})
        EXPECT_NE(page.find(name), std::string::npos) << name;
}

TEST_F(Page, WhatCannotBeShownIsAnErrorAndLeavesNothing) {
    PageContent content;
    const std::string three = map::threeJsFile();
    EXPECT_NE(messageOf(content, three).find("no points"), std::string::npos);
    content.points = somePoints(10);
    const std::string missing = messageOf(content, folder_ / "three.js");
    EXPECT_NE(missing.find("libjs-three"), std::string::npos) << missing;
    EXPECT_EQ(missing.find('\n'), std::string::npos);
    EXPECT_NE(messageOf(content, folder_.path()).find("libjs-three"), std::string::npos);
    content.loops = {{0, 3}};
    content.trajectory = test::straightWay(3);
    EXPECT_NE(messageOf(content, three).find("pose 3 of 3"), std::string::npos);
    content.loops.clear();
    content.trajectory[1].translation().x() = NAN;
    EXPECT_NE(messageOf(content, three).find("not finite"), std::string::npos);
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}
}  // namespace
