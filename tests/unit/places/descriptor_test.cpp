#include "places/descriptor.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <set>

#include "poses.h"
#include "ring_scan.h"

namespace {
using namespace delio;
using places::HeightImage;
using test::poseAtDeg;

/** A yard, seen from its middle by many beams. */
const Eigen::Matrix3Xf& yard() {
    static const Eigen::Matrix3Xf points = [] {
        test::Noise noise;
        return test::ringScan(test::yard(), poseAtDeg(0, 0, 0, 20), {64, 900, -40, 15, 0.01}, noise)
            .points;
    }();
    return points;
}

TEST(HeightImage, LeavesOutTheGround) {
    Eigen::Matrix3Xf points(3, 1600);
    for (int i = 0; i < 40; ++i)
        for (int k = 0; k < 40; ++k)
            points.col(40 * i + k) << 0.25F * static_cast<float>(k), 0.25F * static_cast<float>(i),
                2;
    EXPECT_EQ(HeightImage(points).cells().cols(), 0);
    EXPECT_NEAR(HeightImage(points).groundAt(5, 5), 2, 1e-6);
    EXPECT_TRUE(std::isnan(HeightImage(points).groundAt(50, 5)));
    points.col(820).z() = 3.5F;  // a post, at 5, 5
    const HeightImage post(points);
    ASSERT_EQ(post.cells().cols(), 1);
    EXPECT_LT((post.cells().col(0) - Eigen::Vector2d(5, 5)).norm(), 0.5);
    EXPECT_EQ(post.bands()[0], 2);  // 1 to 2 m above the ground
}

/** A grid of points 0.25 m apart, with x and y from `low` to `high` at that height. */
Eigen::Matrix3Xf level(const Eigen::Vector2f& low, const Eigen::Vector2f& high, float z) {
    const Eigen::Vector2i count = ((high - low) * 4).array().round().cast<int>();
    Eigen::Matrix3Xf points(3, count.prod());
    for (int i = 0; i < count.prod(); ++i)
        points.col(i) << low.x() + 0.25F * static_cast<float>(i % count.x()),
            low.y() + 0.25F * static_cast<float>(i / count.x()), z;
    return points;
}

/** The surfaces together. */
Eigen::Matrix3Xf together(const std::vector<Eigen::Matrix3Xf>& surfaces) {
    Eigen::Matrix3Xf all(3, 0);
    for (const auto& surface : surfaces) {
        all.conservativeResize(3, all.cols() + surface.cols());
        all.rightCols(surface.cols()) = surface;
    }
    return all;
}

/** A wall along x at y = 10, from the ground up to `top`. */
Eigen::Matrix3Xf wall(float top) {
    Eigen::Matrix3Xf points = level({0, 0}, {20, top}, 10);
    points.row(1).swap(points.row(2));
    return points;
}

// A ceiling is above every room: only the wall and the table stand.
TEST(HeightImage, LeavesOutTheCeiling) {
    const auto floor = level({0, 0}, {20, 20}, 0), ceiling = level({0, 0}, {20, 20}, 2.8F),
               table = level({13, 5}, {14, 6}, 0.8F);
    const auto room = together({floor, ceiling, table, wall(2.75F)});
    const auto standing = places::standing(room);
    EXPECT_EQ(standing.cols(), places::standing(together({floor, table, wall(2.75F)})).cols());
    EXPECT_EQ(places::aboveGround(room).cols(), standing.cols() + ceiling.cols());
    const HeightImage image(room);
    EXPECT_EQ(image.cells().cols(), 40 + 4);
    EXPECT_TRUE((image.cells().row(1).array() > 9.5 || image.cells().row(0).array() > 12.5).all());
}

// The top of a high wall, and a slope, are no ceilings.
TEST(HeightImage, KeepsWhatIsNoCeiling) {
    const auto floor = level({0, 0}, {20, 20}, 0);
    Eigen::Matrix3Xf slope = level({0, 0}, {20, 20}, 0);
    slope.row(2) = 2 + 0.3F * slope.row(0).array();
    for (const auto& thing : {wall(6), slope}) {
        const auto all = together({floor, thing});
        EXPECT_EQ(places::standing(all).cols(), places::aboveGround(all).cols());
    }
}

TEST(HeightImage, IsFoundWhereItLies) {
    const Eigen::Isometry3d moved = poseAtDeg(6, -4.3, 2.5, 8);
    const HeightImage here(moved.cast<float>() * yard()), there(yard());
    const auto shifts = shiftsOf(here, there, 8 * M_PI / 180, {0, 0}, 10, 2, 3);
    ASSERT_EQ(shifts.size(), 3U);
    EXPECT_LT((shifts[0].translation - moved.translation()).head<2>().norm(), 0.5);
    EXPECT_NEAR(shifts[0].translation.z(), 2.5, 0.1);
    EXPECT_GT(shifts[0].overlap, 1.3 * shifts[1].overlap);
    EXPECT_LE(shifts[0].overlap, 1);
}

// What meets, counted cell by cell.
TEST(HeightImage, SharesAreTrue) {
    const HeightImage here(yard()), there(yard().leftCols(yard().cols() / 2));
    const auto shift = shiftsOf(here, there, 0, {0.6, 0.2}, 3, 2, 1).at(0);
    const auto keyOf = [](const Eigen::Vector2d& cell) {
        return std::make_pair(std::lround(std::floor(cell.x() / 0.5)),
                              std::lround(std::floor(cell.y() / 0.5)));
    };
    unsigned met = 0, all = 0;
    for (Eigen::Index i = 0; i < there.cells().cols(); ++i) {
        const auto mine = there.bands()[static_cast<std::size_t>(i)];
        all += static_cast<unsigned>(__builtin_popcount(mine));
        const Eigen::Vector2d moved = there.cells().col(i) + shift.translation.head<2>();
        for (Eigen::Index k = 0; k < here.cells().cols(); ++k)
            if (keyOf(here.cells().col(k)) == keyOf(moved))
                met += static_cast<unsigned>(
                    __builtin_popcount(mine & here.bands()[static_cast<std::size_t>(k)]));
    }
    EXPECT_NEAR(shift.overlap, static_cast<double>(met) / all, 1e-12);
}

TEST(HeightImage, OfNothingIsNowhere) {
    const HeightImage nothing(Eigen::Matrix3Xf(3, 0)), here(yard());
    EXPECT_TRUE(shiftsOf(here, nothing, 0, {0, 0}, 5, 2, 3).empty());
    EXPECT_TRUE(shiftsOf(nothing, here, 0, {0, 0}, 5, 2, 3).empty());
}

constexpr double kDeg = M_PI / 180;

/** Walls that look these ways (degrees), the first the broadest; and the ground. */
paper::SurfaceNormals wallsAt(const std::vector<double>& azimuths_deg, double turned_deg = 0) {
    const auto count = static_cast<Eigen::Index>(azimuths_deg.size());
    paper::SurfaceNormals walls;
    walls.directions.resize(3, 60 * count);
    walls.planarity.setOnes(60 * count);
    for (Eigen::Index i = 0; i < 60 * count; ++i) {
        const auto wall = i % count;
        const double scatter = 0.02 * static_cast<double>(i / count % 20 - 10),
                     azimuth = (azimuths_deg[static_cast<std::size_t>(wall)] + turned_deg) * kDeg;
        walls.directions.col(i) =
            Eigen::Vector3f(static_cast<float>(std::cos(azimuth + scatter * kDeg)),
                            static_cast<float>(std::sin(azimuth + scatter * kDeg)), 0);
        if (wall > 0) walls.planarity[i] = 0.5F;
        if (i % 3 == 2) walls.directions.col(i) = Eigen::Vector3f::UnitZ();
    }
    return walls;
}

TEST(WallOrientations, FindTheTurn) {
    const places::WallOrientations here(wallsAt({10, 47, 100})),
        there(wallsAt({10, 47, 100}, -7.3));
    const auto turns = here.turnsOf(there, 3 * kDeg, 10 * kDeg, 3);
    ASSERT_FALSE(turns.empty());
    EXPECT_NEAR(turns.front(), 7.3 * kDeg, 0.3 * kDeg);
}

// Walls are seen from either side: which way round is what was expected.
TEST(WallOrientations, GoRoundAsExpected) {
    const places::WallOrientations here(wallsAt({10, 47, 100})),
        there(wallsAt({10, 47, 100}, -7.3));
    const auto turns = here.turnsOf(there, -175 * kDeg, 10 * kDeg, 3);
    ASSERT_FALSE(turns.empty());
    EXPECT_NEAR(turns.front(), (7.3 - 180) * kDeg, 0.3 * kDeg);
}

TEST(WallOrientations, OfBlocksHaveSeveralTurnsTheNearerFirst) {
    const places::WallOrientations here(wallsAt({0, 90})), there(wallsAt({0, 90}, -20));
    const auto turns = here.turnsOf(there, 0, 120 * kDeg, 4);
    ASSERT_GE(turns.size(), 3U);
    EXPECT_NEAR(turns.front(), 20 * kDeg, 0.3 * kDeg);  // the broad wall on the broad one
}

TEST(WallOrientations, OfGroundAloneSayNothing) {
    paper::SurfaceNormals ground;
    ground.directions = Eigen::Vector3f::UnitZ().replicate(1, 100);
    ground.planarity.setOnes(100);
    const places::WallOrientations here(ground), walls(wallsAt({10}));
    EXPECT_TRUE(here.turnsOf(walls, 0, 1, 3).empty());
    EXPECT_TRUE(walls.turnsOf(here, 0, 1, 3).empty());
    EXPECT_TRUE(places::WallOrientations(paper::SurfaceNormals{}).turnsOf(walls, 0, 1, 3).empty());
}
}  // namespace
