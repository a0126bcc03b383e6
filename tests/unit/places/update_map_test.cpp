#include "places/update_map.h"

#include <gtest/gtest.h>

#include <functional>

#include "delio/core/error.h"
#include "places/descriptor.h"
#include "test_data.h"

namespace {
using namespace delio;
using Cloud = Eigen::Matrix3Xf;

constexpr double kFirst_s = 1.7e9, kDay_s = 86400;

/** Points 0.5 m apart on a square of `count` by `count`, from `corner` on. */
Cloud square(const Eigen::Vector3f& corner, int count) {
    Cloud points(3, count * count);
    for (int i = 0; i < count * count; ++i)
        points.col(i) = corner + 0.5F * Eigen::Vector3f(static_cast<float>(i % count),
                                                        static_cast<float>(i / count), 0);
    return points;
}

Cloud both(const Cloud& a, const Cloud& b) {
    Cloud all(3, a.cols() + b.cols());
    all << a, b;
    return all;
}

/** A map of bare ground and a car, and days on which somebody drives there. */
class UpdatedMaps : public testing::Test {
 protected:
    UpdatedMaps() {
        MapContent content;
        content.graph.addNode(Eigen::Isometry3d::Identity());
        content.drives.push_back({"first", 0, {kFirst_s}});
        content.submaps.emplace_back();
        content.descriptor = [this](std::size_t) {
            return places::Descriptor(both(ground_, car_));
        };
        content.points = [this](std::size_t) { return both(ground_, car_); };
        StoredMap::save(content, path());
    }

    std::string path() const { return (folder_ / "map.delio").string(); }
    StoredMap map() const { return StoredMap(path()); }

    /** A visit that sees `points` and through all points higher than 0.5 m which it does not see.
     */
    UpdateFigures visit(int day, const Cloud& points) {
        VisitScans scans;
        scans.visit = {"day " + std::to_string(day), kFirst_s + day * kDay_s,
                       kFirst_s + day * kDay_s + 10};
        scans.poses.push_back(Eigen::Isometry3d::Identity());
        scans.points = points;
        scans.seenThrough = [&](const Cloud& all) {
            std::vector<std::uint8_t> through;
            for (Eigen::Index i = 0; i < all.cols(); ++i)
                through.push_back(all(2, i) > 0.5F &&
                                  (points.colwise() - all.col(i)).colwise().norm().minCoeff() >
                                      0.1F);
            return through;
        };
        const StoredMap before(path());
        const auto result = updated(before, scans);
        StoredMap::save(result.content, path());
        return result.figures;
    }
    /** Points of the map above 0.5 m, as it was on a day. */
    Eigen::Index high(const std::string& time = "") const {
        const StoredMap now(path());
        const Cloud cloud = time.empty() ? now.cloud(0.01) : now.cloud(0.01, now.visitAt(time));
        return (cloud.row(2).array() > 0.5F).count();
    }
    static std::string noonOf(int day) {
        return std::to_string(static_cast<long>(kFirst_s + day * kDay_s + 1000));
    }

    test::TemporaryFolder folder_;
    const Cloud ground_ = square({-5, -5, 0}, 20), car_ = square({3, 3, 1}, 4),
                bin_ = square({-4, 3, 1}, 3);
};

TEST_F(UpdatedMaps, OneVisitChangesNothing) {
    const auto figures = visit(1, both(ground_, bin_));
    EXPECT_EQ(figures.doubted, 16U);
    EXPECT_EQ(figures.seenOnce, 9U);
    EXPECT_EQ(figures.gone + figures.confirmed, 0U);
    EXPECT_EQ(high(), car_.cols());
    EXPECT_EQ(map().points(0).cols(), ground_.cols() + car_.cols());
    EXPECT_EQ(map().visits().size(), 2U);
}

TEST_F(UpdatedMaps, TwoContradictionsTakeAPartOut) {
    visit(1, ground_);
    EXPECT_EQ(visit(2, ground_).gone, 16U);
    EXPECT_EQ(high(), 0);
    EXPECT_EQ(map().points(0).cols(), ground_.cols());
    // It was there until the first visit that saw through it.
    EXPECT_EQ(high(noonOf(0)), car_.cols());
    EXPECT_EQ(high(noonOf(1)), 0);
    for (const auto& layer : map().layers(0))
        if (layer.isGone()) {
            EXPECT_EQ(layer.first, 0U);
            EXPECT_EQ(layer.last, 0U);
            EXPECT_EQ(layer.doubted, 1U);
            EXPECT_EQ(layer.points.cols(), car_.cols());
        }
    // Another one in its place is new.
    EXPECT_EQ(visit(3, both(ground_, car_)).seenOnce, 16U);
    EXPECT_EQ(high(), 0);
    EXPECT_EQ(visit(4, both(ground_, car_)).confirmed, 16U);
    EXPECT_EQ(high(), car_.cols());
    EXPECT_EQ(high(noonOf(2)), 0);
    EXPECT_EQ(high(noonOf(3)), car_.cols());
}

TEST_F(UpdatedMaps, APartThatIsSeenBetweenStays) {
    visit(1, ground_);
    visit(2, both(ground_, car_));
    EXPECT_EQ(visit(3, ground_).doubted, 16U);
    EXPECT_EQ(high(), car_.cols());
}

TEST_F(UpdatedMaps, HiddenPartsStayAsTheyAre) {
    // Nothing of the ground is seen, and nothing is seen through below 0.5 m.
    for (int day = 1; day < 4; ++day) visit(day, car_);
    EXPECT_EQ(map().points(0).cols(), ground_.cols() + car_.cols());
}

TEST_F(UpdatedMaps, ANewPartNeedsTwoVisits) {
    visit(1, both(both(ground_, car_), bin_));
    EXPECT_EQ(high(), car_.cols());
    EXPECT_EQ(visit(2, both(both(ground_, car_), bin_)).confirmed, 9U);
    EXPECT_EQ(high(), car_.cols() + bin_.cols());
    EXPECT_EQ(high(noonOf(0)), car_.cols());
    EXPECT_EQ(high(noonOf(1)), car_.cols() + bin_.cols());
}

TEST_F(UpdatedMaps, WhatWasSeenOnceAndIsSeenThroughIsDropped) {
    visit(1, both(both(ground_, car_), bin_));
    EXPECT_EQ(visit(2, both(ground_, car_)).dropped, 9U);
    EXPECT_EQ(visit(3, both(both(ground_, car_), bin_)).seenOnce, 9U);
    EXPECT_EQ(high(), car_.cols());
}

TEST_F(UpdatedMaps, WrittenOnceMoreItIsTheSame) {
    visit(1, both(ground_, bin_));
    const std::string before = test::readText(path());
    {
        const StoredMap map(path());
        StoredMap::save(map.content(), path());
    }
    EXPECT_TRUE(test::readText(path()) == before);
}

std::string faultOf(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

TEST_F(UpdatedMaps, VisitsComeInTheirOrder) {
    visit(2, ground_);
    for (const int day : {2, 1})
        EXPECT_NE(faultOf([&] { visit(day, ground_); }).find("not after the map's visit of 2023"),
                  std::string::npos);
    const StoredMap before(path());
    VisitScans withoutTime;
    withoutTime.visit.name = "when";
    EXPECT_NE(faultOf([&] { updated(before, withoutTime); }).find("no Unix times"),
              std::string::npos);
}

TEST_F(UpdatedMaps, TimesAreDatesOrUnixTimes) {
    visit(1, ground_);
    const auto at = [&](const std::string& time) { return StoredMap(path()).visitAt(time); };
    EXPECT_EQ(at("2023-11-14T22:13:20Z"), 0U);  // 1.7e9
    EXPECT_EQ(at("1700000000.5"), 0U);
    EXPECT_EQ(at("2023-11-15"), 0U);
    EXPECT_EQ(at("2023-11-15T22:13"), 0U);
    EXPECT_EQ(at("2023-11-15T22:14"), 1U);
    EXPECT_EQ(at("2030-01-01"), 1U);
    EXPECT_NE(faultOf([&] { at("2023-11-14T22:13:19Z"); }).find("begins at 2023-11-14T22:13:20Z"),
              std::string::npos);
    for (const char* text : {"", "yesterday", "2023-11-14x", "2023-02-31", "-5", "nan", "14.11.23"})
        EXPECT_NE(faultOf([&] { at(text); }).find("is not a time"), std::string::npos) << text;
}

TEST_F(UpdatedMaps, AMapWithoutTimesHasNoDays) {
    visit(1, ground_);
    const StoredMap before(path());
    MapContent timeless = before.content();
    timeless.visits[0].begin_s = timeless.visits[1].begin_s = 0;
    StoredMap::save(timeless, (folder_ / "timeless.delio").string());
    const StoredMap without((folder_ / "timeless.delio").string());
    EXPECT_NE(faultOf([&] { without.visitAt("2030-01-01"); }).find("have no times"),
              std::string::npos);
}
}  // namespace
