#include "places/descriptor.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace {
using namespace delio;

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
