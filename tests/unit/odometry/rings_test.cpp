#include "odometry/rings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numeric>

#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using delio::odometry::ringsOf;
using delio::test::Noise;
using Rings = std::vector<std::uint16_t>;

constexpr unsigned kRings = 64;

/** 64 rings of an HDL-64E's field of view, 0 to 63, ranges as they come, 2 cm of noise. */
delio::test::RingScan hdl64() {
    Noise noise;
    return delio::test::ringScan(delio::test::yard(), Eigen::Isometry3d::Identity(),
                                 {kRings, 400, -24.8, 2, 0.02}, noise);
}

delio::test::RingScan reordered(const delio::test::RingScan& scan,
                                const std::vector<Eigen::Index>& order) {
    delio::test::RingScan result;
    result.points = scan.points(Eigen::all, order);
    for (const auto i : order) result.rings.push_back(scan.rings[static_cast<std::size_t>(i)]);
    return result;
}

std::vector<Eigen::Index> upTo(Eigen::Index count) {
    std::vector<Eigen::Index> order(static_cast<std::size_t>(count));
    std::iota(order.begin(), order.end(), 0);
    return order;
}

TEST(Rings, RingAfterRingIsTakenAsItComes) {
    const auto scan = hdl64();
    ASSERT_EQ(scan.rings.back(), kRings - 1);
    EXPECT_EQ(ringsOf(scan.points), scan.rings);
}

TEST(Rings, PointsMayBeMissing) {
    const auto scan = hdl64();
    std::vector<Eigen::Index> some;
    for (const auto i : upTo(scan.points.cols()))
        if (i % 7 != 0 && i % 11 > 3) some.push_back(i);
    const auto thinned = reordered(scan, some);
    EXPECT_EQ(ringsOf(thinned.points), thinned.rings);
}

TEST(Rings, TheSensorMayTurnClockwise) {
    auto scan = hdl64();
    scan.points.row(1) *= -1;
    EXPECT_EQ(ringsOf(scan.points), scan.rings);
}

TEST(Rings, AreNumberedFromTheTopIfTheLowestComesFirst) {
    const auto scan = hdl64();
    auto order = upTo(scan.points.cols());
    std::reverse(order.begin(), order.end());
    const auto expected = reordered(scan, order);
    EXPECT_EQ(ringsOf(expected.points), expected.rings);
}

// Beams that meet elsewhere leave no ring its elevation.
TEST(Rings, AreToldByTheOrderWhereElevationsAreBlurred) {
    auto scan = hdl64();
    scan.points.row(2).array() += 0.5F;
    EXPECT_EQ(ringsOf(scan.points), scan.rings);
    auto order = upTo(scan.points.cols());
    std::reverse(order.begin(), order.end());
    auto expected = reordered(scan, order);
    for (auto& ring : expected.rings) ring = static_cast<std::uint16_t>(kRings - 1 - ring);
    EXPECT_EQ(ringsOf(expected.points), expected.rings);
}

/** Beams of real sensors, from the top, and how they are spread. */
std::vector<double> evenly(unsigned beams, double highest, double lowest) {
    std::vector<double> elevations;
    for (unsigned i = 0; i < beams; ++i)
        elevations.push_back(highest - i * (highest - lowest) / (beams - 1));
    return elevations;
}

std::vector<double> blocksOf(std::initializer_list<std::vector<double>> blocks) {
    std::vector<double> all;
    for (const auto& block : blocks) all.insert(all.end(), block.begin(), block.end());
    return all;
}

struct Model {
    const char* name;
    std::vector<double> elevations_deg;
};

std::vector<Model> models() {
    return {{"VLP-16", evenly(16, 15, -15)},
            {"HDL-32E", evenly(32, 10.67, -30.67)},
            {"VLP-32C", {15,     10.333, 7,      4.667,  3.333,  2.333,  1.667,   1.333,
                         1,      0.667,  0.333,  0,      -0.333, -0.667, -1,      -1.333,
                         -1.667, -2,     -2.333, -2.667, -3,     -3.333, -3.667,  -4,
                         -4.667, -5.333, -6.148, -7.254, -8.843, -11.31, -15.639, -25}},
            {"HDL-64E", blocksOf({evenly(32, 2, -8.33), evenly(32, -8.83, -24.33)})},
            {"OS1-128", evenly(128, 22.5, -22.5)},
            {"VLS-128", blocksOf({{15, 12, 9, 7, 6, 5, 4.3, 3.6, 3},
                                  evenly(80, 2.5, -6.19),
                                  evenly(39, -6.5, -25)})}};
}

double smallestStep(const Model& model) {
    double step = 90;
    for (std::size_t i = 1; i < model.elevations_deg.size(); ++i)
        step = std::min(step, model.elevations_deg[i - 1] - model.elevations_deg[i]);
    return step;
}

delio::test::RingScan scanBy(const Model& model) {
    Noise noise;
    const auto beams = static_cast<unsigned>(model.elevations_deg.size());
    return delio::test::ringScan(delio::test::yard(), Eigen::Isometry3d::Identity(),
                                 {beams, 720, 0, 0, 0.02, model.elevations_deg}, noise);
}

std::vector<Eigen::Index> shuffled(Eigen::Index count) {
    auto order = upTo(count);
    std::shuffle(order.begin(), order.end(), std::mt19937(1));  // any order will do
    return order;
}

/** Column after column, as the lasers fire. */
std::vector<Eigen::Index> asFired(const Eigen::Matrix3Xf& points) {
    auto order = upTo(points.cols());
    std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
        const auto column = [&](Eigen::Index i) {
            return std::floor(std::atan2(points(1, i), points(0, i)) * 360 / M_PI);
        };
        return column(a) < column(b);
    });
    return order;
}

double shareOfEqual(const Rings& a, const Rings& b) {
    double equal = 0;
    for (std::size_t i = 0; i < a.size(); ++i) equal += a[i] == b[i];
    return equal / static_cast<double>(a.size());
}

TEST(Rings, OfAnySensorInAnyOrder) {
    for (const auto& model : models()) {
        const auto scan = scanBy(model);
        ASSERT_EQ(scan.rings.back() + 1U, model.elevations_deg.size()) << model.name;
        EXPECT_EQ(ringsOf(scan.points), scan.rings) << model.name;
        const auto fired = reordered(scan, asFired(scan.points));
        EXPECT_EQ(ringsOf(fired.points), fired.rings) << model.name;
        const auto mixed = reordered(scan, shuffled(scan.points.cols()));
        EXPECT_EQ(ringsOf(mixed.points), mixed.rings) << model.name;
    }
}

TEST(Rings, OfPartOfThePoints) {
    for (const auto& model : models()) {
        const auto scan = scanBy(model);
        std::vector<Eigen::Index> some;  // a sector at the back, and two thirds of the others
        for (const auto i : shuffled(scan.points.cols()))
            if (scan.points(0, i) > 0 && i % 3 != 0) some.push_back(i);
        const auto part = reordered(scan, some);
        EXPECT_EQ(ringsOf(part.points), part.rings) << model.name;
    }
}

TEST(Rings, MayBeBlurred) {
    for (const auto& model : models()) {
        auto scan = reordered(scanBy(model), shuffled(scanBy(model).points.cols()));
        Noise noise;
        const double sigma = smallestStep(model) / 6 * M_PI / 180;
        for (Eigen::Index i = 0; i < scan.points.cols(); ++i) {
            const Eigen::Vector3f p = scan.points.col(i);
            const Eigen::Vector3f up(-p.z() * p.x() / p.head<2>().norm(),
                                     -p.z() * p.y() / p.head<2>().norm(), p.head<2>().norm());
            scan.points.col(i) += static_cast<float>(sigma * noise.normal()) * up;
        }
        EXPECT_GT(shareOfEqual(ringsOf(scan.points), scan.rings), 0.99) << model.name;
    }
}

// 0.2 m at 10 m are three steps of an HDL-64E.
TEST(Rings, BeamsMayMeetAboveTheOrigin) {
    for (const auto& model : models()) {
        auto scan = reordered(scanBy(model), shuffled(scanBy(model).points.cols()));
        scan.points.row(2).array() += 0.207F;
        EXPECT_GT(shareOfEqual(ringsOf(scan.points), scan.rings), 0.99) << model.name;
    }
}

// In the axes of a vehicle whose sensor is mounted on its side no ring has an elevation of its own.
// Two or three modes of such a cloud are no beams.
TEST(Rings, LyingOnItsSideLeavesMoreThanAFewRings) {
    for (const auto& model : models()) {
        auto scan = scanBy(model);
        scan.points = delio::test::rotationAbout({1, 0, 0}, 90).cast<float>() * scan.points;
        const Rings found = ringsOf(scan.points);
        EXPECT_GE(*std::max_element(found.begin(), found.end()), 15) << model.name;
    }
}

TEST(Rings, OneRingIsOne) {
    Noise noise;
    Eigen::Matrix3Xf points(3, 2000);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const double azimuth = M_PI * noise.uniform();
        points.col(i) << static_cast<float>(10 * std::cos(azimuth)),
            static_cast<float>(10 * std::sin(azimuth)), -1;
    }
    EXPECT_EQ(ringsOf(points), Rings(2000, 0));
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        points(2, i) += static_cast<float>(0.005 * noise.normal());
    EXPECT_EQ(ringsOf(points), Rings(2000, 0));
    points.colwise() = Eigen::Vector3f(0, 0, 4);  // straight up, where no azimuth is
    EXPECT_EQ(ringsOf(points), Rings(2000, 0));
}

TEST(Rings, PointsAnywhereGoIntoEqualSteps) {
    Noise noise;
    Eigen::Matrix3Xf points(3, 20000);
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        points.col(i) = (20 * noise.direction()).cast<float>();
    const Rings found = ringsOf(points);
    EXPECT_EQ(*std::min_element(found.begin(), found.end()), 0);
    EXPECT_EQ(*std::max_element(found.begin(), found.end()), 63);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const double elevation = std::asin(points(2, i) / points.col(i).norm()) / M_PI * 180;
        EXPECT_NEAR(found[static_cast<std::size_t>(i)], (90 - elevation) / 180 * 64 - 0.5, 1);
    }
}

// 16 bits would run over, and what counts the points of a ring would have too few places.
TEST(Rings, AnyNumberOfHalfTurnsIsNoHarm) {
    for (const int rounds : {300, 65540, 65700, 131100}) {
        Eigen::Matrix3Xf points(3, rounds);
        for (int i = 0; i < rounds; ++i)
            points.col(i) << 10, (i % 2 == 0 ? 0.1F : -0.1F), static_cast<float>(i % 50) * 0.1F;
        const Rings found = ringsOf(points);
        ASSERT_EQ(found.size(), static_cast<std::size_t>(rounds));
        EXPECT_LT(*std::max_element(found.begin(), found.end()), 64);
        for (int i = 1; i < 50; ++i)
            EXPECT_LE(found[static_cast<std::size_t>(i)], found[static_cast<std::size_t>(i) - 1]);
    }
}

TEST(Rings, FewPointsAreFine) {
    EXPECT_TRUE(ringsOf({}).empty());
    EXPECT_EQ(ringsOf(Eigen::Vector3f(3, 4, 5)), Rings{0});
    EXPECT_EQ(ringsOf(Eigen::Vector3f(0, 0, 0)), Rings{0});
    Eigen::Matrix3Xf two(3, 2);
    two << 10, 10, 0, 0, 1, -1;
    EXPECT_EQ(ringsOf(two), (Rings{0, 63}));
}

TEST(Rings, AreNumberedFromTheTop) {
    Eigen::Matrix3Xf points(3, 4);
    points << 10, 10, 10, 10, 0, 0, 0, 0, -1, 2, 0, 2.1F;
    EXPECT_EQ(delio::odometry::ringsFromTop(points, {0, 1, 7, 1}),
              (std::vector<std::uint16_t>{2, 0, 1, 0}));
    EXPECT_TRUE(delio::odometry::ringsFromTop({}, {}).empty());
}
}  // namespace
