#include "paper/line_cloud.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "ring_scan.h"

namespace {
using namespace delio;
using paper::drawLines;
using paper::LineCloud;

test::RingScan scan() {
    test::Noise noise;
    return test::ringScan(test::yard(), Eigen::Isometry3d::Identity(), {16, 720, -20, 8, 0.01},
                          noise);
}

std::size_t sectorOf(const Eigen::Vector3d& p, unsigned sectors) {
    return static_cast<std::size_t>((std::atan2(p.y(), p.x()) / (2 * M_PI) + 0.5) * sectors);
}

bool same(const LineCloud& a, const LineCloud& b) {
    return a.lengths.size() == b.lengths.size() && a.midpoints == b.midpoints &&
           a.directions == b.directions && a.lengths == b.lengths;
}

/** A point by its coordinates: the ends of a line are midpoint -+ length/2 direction. */
class PointIndex {
 public:
    explicit PointIndex(const test::RingScan& from) : scan_(from) {}

    /** Column of the point next to `p`, which has to be there. */
    Eigen::Index at(const Eigen::Vector3f& p) const {
        Eigen::Index nearest = 0;
        const float squared =
            (scan_.points.colwise() - p).colwise().squaredNorm().minCoeff(&nearest);
        EXPECT_LT(squared, 1e-8F);
        return nearest;
    }

 private:
    const test::RingScan& scan_;
};

TEST(LineCloud, LinesConnectNeighbouringRingsWithinASector) {
    const auto made = scan();
    const LineCloudOptions options;
    const auto lines = drawLines(made.points, made.rings, options);
    ASSERT_GT(lines.midpoints.cols(), 1500);
    ASSERT_EQ(lines.directions.cols(), lines.midpoints.cols());
    ASSERT_EQ(lines.lengths.size(), lines.midpoints.cols());
    const PointIndex index(made);
    std::map<std::pair<std::uint16_t, std::size_t>, unsigned> inBin;
    for (Eigen::Index i = 0; i < lines.midpoints.cols(); ++i) {
        EXPECT_NEAR(lines.directions.col(i).norm(), 1, 1e-5);
        EXPECT_LE(lines.lengths[i], 5.0001F);
        const Eigen::Vector3f half = lines.lengths[i] / 2 * lines.directions.col(i);
        const auto a = index.at(lines.midpoints.col(i) - half);
        const auto b = index.at(lines.midpoints.col(i) + half);
        const auto ring = made.rings[static_cast<std::size_t>(a)];
        EXPECT_EQ(made.rings[static_cast<std::size_t>(b)], ring + 1);
        const auto sector = sectorOf(made.points.col(a).cast<double>(), options.sectors);
        EXPECT_EQ(sectorOf(made.points.col(b).cast<double>(), options.sectors), sector);
        EXPECT_LE((++inBin[{ring, sector}]), options.kept);
    }
    EXPECT_EQ(lines.drawn, options.drawn * inBin.size());
}

/** Faces of the scene's blocks that a point lies on: block, axis, and low or high end. */
std::set<std::size_t> facesAt(const test::Scene& scene, const Eigen::Vector3d& p) {
    std::set<std::size_t> faces;
    for (std::size_t b = 0; b < scene.size(); ++b)
        for (int axis = 0; axis < 3; ++axis) {
            const auto number = 6 * b + 2 * static_cast<std::size_t>(axis);
            if (std::abs(p[axis] - scene[b].low[axis]) < 1e-3) faces.insert(number);
            if (std::abs(p[axis] - scene[b].high[axis]) < 1e-3) faces.insert(number + 1);
        }
    return faces;
}

/** Share of the lines that have both ends on one face. */
double shareOnOneSurface(const LineCloud& lines, const test::Scene& scene) {
    double inside = 0;
    for (Eigen::Index i = 0; i < lines.midpoints.cols(); ++i) {
        const Eigen::Vector3f half = lines.lengths[i] / 2 * lines.directions.col(i);
        const auto a = facesAt(scene, (lines.midpoints.col(i) - half).cast<double>());
        const auto b = facesAt(scene, (lines.midpoints.col(i) + half).cast<double>());
        inside +=
            std::any_of(a.begin(), a.end(), [&](std::size_t face) { return b.count(face) > 0; });
    }
    return inside / static_cast<double>(lines.midpoints.cols());
}

// Why the shortest are kept.
TEST(LineCloud, LinesStayOnOneSurface) {
    test::Noise noise;
    const auto scene = test::room();
    const auto made =
        test::ringScan(scene, Eigen::Isometry3d::Identity(), {64, 1440, -24, 8, 0}, noise);
    LineCloudOptions all;
    all.kept = all.drawn;
    const double kept = shareOnOneSurface(drawLines(made.points, made.rings, {}), scene);
    const double drawn = shareOnOneSurface(drawLines(made.points, made.rings, all), scene);
    EXPECT_GT(kept, 0.97);
    EXPECT_GT(1 - drawn, 1.5 * (1 - kept));
}

TEST(LineCloud, TheShortestOfThoseDrawnAreKept) {
    const auto made = scan();
    LineCloudOptions all;
    all.kept = all.drawn;
    all.max_length = 1000;
    LineCloudOptions some = all;
    some.kept = 5;
    const auto drawn = drawLines(made.points, made.rings, all);
    const auto kept = drawLines(made.points, made.rings, some);
    EXPECT_EQ(static_cast<std::size_t>(drawn.lengths.size()), drawn.drawn);  // 20 in each bin
    ASSERT_EQ(static_cast<std::size_t>(kept.lengths.size()), kept.drawn / 4);
    for (Eigen::Index bin = 0; bin < kept.lengths.size() / 5; ++bin) {
        std::vector<float> lengths(drawn.lengths.data() + 20 * bin,
                                   drawn.lengths.data() + 20 * (bin + 1));
        std::sort(lengths.begin(), lengths.end());
        for (Eigen::Index i = 0; i < 5; ++i)
            EXPECT_EQ(kept.lengths[5 * bin + i], lengths[static_cast<std::size_t>(i)]);
    }
}

TEST(LineCloud, LongLinesAreLeftOut) {
    const auto made = scan();
    LineCloudOptions options;
    options.max_length = 0.5;
    const auto lines = drawLines(made.points, made.rings, options);
    EXPECT_GT(lines.lengths.size(), 100);
    EXPECT_LE(lines.lengths.maxCoeff(), 0.5F);
    EXPECT_LT(lines.lengths.size(), drawLines(made.points, made.rings, {}).lengths.size());
}

TEST(LineCloud, TheSeedDecidesTheDraw) {
    const auto made = scan();
    LineCloudOptions other;
    other.seed = 2;
    const auto once = drawLines(made.points, made.rings, {});
    EXPECT_TRUE(same(once, drawLines(made.points, made.rings, {})));
    EXPECT_FALSE(same(once, drawLines(made.points, made.rings, other)));
    // Bins draw one by one: what lies in the others does not matter.
    test::RingScan top;
    for (std::size_t i = 0; i < made.rings.size() && made.rings[i] < 6; ++i)
        top.rings.push_back(made.rings[i]);
    top.points = made.points.leftCols(static_cast<Eigen::Index>(top.rings.size()));
    const auto part = drawLines(top.points, top.rings, {});
    ASSERT_GT(part.lengths.size(), 500);
    EXPECT_EQ(part.midpoints, once.midpoints.leftCols(part.midpoints.cols()));
}

TEST(LineCloud, DrawsFromAllOfARing) {
    // Two rings of 1000 points in one sector: 10 000 draws meet every tenth of either ring.
    Eigen::Matrix3Xf points(3, 2000);
    std::vector<std::uint16_t> rings;
    for (int i = 0; i < 2000; ++i) {
        points.col(i) << 10, static_cast<float>(i % 1000) * 1e-3F, i < 1000 ? 1.0F : 0.0F;
        rings.push_back(i < 1000 ? 0 : 1);
    }
    LineCloudOptions options;
    options.drawn = options.kept = 10000;
    const auto lines = drawLines(points, rings, options);
    ASSERT_EQ(lines.lengths.size(), 10000);
    std::map<int, int> upper, lower;
    for (Eigen::Index i = 0; i < lines.lengths.size(); ++i) {
        const Eigen::Vector3f half = lines.lengths[i] / 2 * lines.directions.col(i);
        ++upper[static_cast<int>((lines.midpoints(1, i) - half.y()) * 10 + 0.005F)];
        ++lower[static_cast<int>((lines.midpoints(1, i) + half.y()) * 10 + 0.005F)];
    }
    for (const auto& counts : {upper, lower})
        for (int tenth = 0; tenth < 10; ++tenth)  // 1000 +- 30, one sigma
            EXPECT_NEAR(counts.at(tenth), 1000, 150);
}

TEST(LineCloud, RingsWithAGapAreNotConnected) {
    Eigen::Matrix3Xf points(3, 2);
    points << 10, 10, 1, 1, 0, 0.5F;
    EXPECT_EQ(drawLines(points, {0, 2}, {}).lengths.size(), 0);
    const auto lines = drawLines(points, {1, 0}, {});  // any order of the points
    EXPECT_EQ(lines.lengths.size(), 5);
    EXPECT_EQ(lines.drawn, 20U);
    EXPECT_EQ(lines.lengths.maxCoeff(), 0.5F);
}

TEST(LineCloud, OneRingHasNoLines) {
    auto made = scan();
    std::fill(made.rings.begin(), made.rings.end(), std::uint16_t{3});
    EXPECT_EQ(drawLines(made.points, made.rings, {}).midpoints.cols(), 0);
    std::fill(made.rings.begin(), made.rings.end(), std::uint16_t{0});
    EXPECT_EQ(drawLines(made.points, made.rings, {}).midpoints.cols(), 0);
}

TEST(LineCloud, PointsThatCoincideMakeNoLine) {
    const Eigen::Matrix3Xf points = Eigen::Vector3f(10, 1, 0).replicate(1, 10);
    const auto lines = drawLines(points, {0, 0, 0, 0, 0, 1, 1, 1, 1, 1}, {});
    EXPECT_EQ(lines.midpoints.cols(), 0);
}

TEST(LineCloud, Empty) {
    const auto lines = drawLines({}, {}, {});
    EXPECT_EQ(lines.midpoints.cols(), 0);
    EXPECT_EQ(lines.drawn, 0U);
}

TEST(LineCloud, TurningTurnsMidpointsAndDirections) {
    const auto made = scan();
    const auto lines = drawLines(made.points, made.rings, {});
    const Eigen::Matrix3d R = test::rotationAbout({1, 2, 3}, 70);
    const auto turned = paper::rotated(lines, R);
    const Eigen::Matrix3Xd expected = R * lines.midpoints.cast<double>();
    EXPECT_LT((turned.midpoints.cast<double>() - expected).cwiseAbs().maxCoeff(), 1e-4);
    EXPECT_LT((turned.directions.cast<double>() - R * lines.directions.cast<double>())
                  .cwiseAbs()
                  .maxCoeff(),
              1e-6);
    EXPECT_EQ(turned.lengths, lines.lengths);
}
}  // namespace
