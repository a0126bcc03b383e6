#include "places/place_index.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>

namespace {
using namespace delio;
using places::HeightImage;
using places::PlaceIndex;

using Large = std::map<std::pair<int, int>, unsigned>;  //!< bands of cells of 2 m

/** Of `count` cells within `reach` half metres: what stands there is made up. */
HeightImage image(unsigned seed, int reach, Eigen::Index count) {
    std::mt19937 random(seed);
    const auto draw = [&](int most) {
        return static_cast<int>(random() % static_cast<unsigned>(2 * most)) - most;
    };
    Eigen::Matrix2Xd cells(2, count);
    std::vector<std::uint8_t> bands;
    for (Eigen::Index i = 0; i < count; ++i) {
        cells.col(i) = 0.5 * Eigen::Vector2d(draw(reach), draw(reach)).array() + 0.25;
        bands.push_back(static_cast<std::uint8_t>(1 + random() % 255));
    }
    return {cells, std::move(bands), {}, {}};
}

HeightImage moved(const HeightImage& image, double sign, const Eigen::Vector2d& by) {
    return {(sign * image.cells()).colwise() + by, image.bands(), {}, {}};
}

Large largeOf(const HeightImage& image, double yaw) {
    Large large;
    const Eigen::Matrix2Xd cells = Eigen::Rotation2Dd(yaw).toRotationMatrix() * image.cells();
    for (Eigen::Index i = 0; i < cells.cols(); ++i)
        large[{static_cast<int>(std::floor(cells(0, i) / 2)),
               static_cast<int>(std::floor(cells(1, i) / 2))}] |=
            image.bands()[static_cast<std::size_t>(i)];
    return large;
}

unsigned bitsOf(unsigned bands) {
    unsigned bits = 0;
    for (; bands != 0; bands /= 2) bits += bands % 2;
    return bits;
}

/** Of all headings, cell by cell and shift by shift. */
double mostOf(const HeightImage& place, const HeightImage& cloud) {
    const Large there = largeOf(place, 0);
    double best = 0;
    for (int turn = 0; turn < 72; ++turn) {
        const Large seen = largeOf(cloud, 2 * M_PI * turn / 72);
        unsigned all = 0, most = 0;
        for (const auto& [cell, bands] : seen) all += bitsOf(bands);
        for (int dx = -10; dx <= 10; ++dx)
            for (int dy = -10; dy <= 10; ++dy) {
                unsigned met = 0;
                for (const auto& [cell, bands] : seen) {
                    const auto at = there.find({cell.first + dx, cell.second + dy});
                    if (at != there.end()) met += bitsOf(bands & at->second);
                }
                most = std::max(most, met);
            }
        best = std::max(best, static_cast<double>(most) / all);
    }
    return best;
}

// More than fits into a byte, and more in the place than is seen.
TEST(PlaceIndex, TellsWhichPlaceItIsAndWhere) {
    PlaceIndex index;
    for (unsigned seed = 1; seed <= 5; ++seed) index.add(image(seed, 80, 2000));
    const auto seen = moved(image(4, 80, 2000), 1, {-14, 20});
    const auto found = index.find(seen, 3);
    ASSERT_EQ(found.size(), 3U);
    EXPECT_EQ(found[0].place, 3U);
    EXPECT_EQ(found[0].shift.overlap, 1);
    EXPECT_EQ(found[0].shift.yaw, 0);
    EXPECT_EQ(found[0].shift.translation, Eigen::Vector3d(14, -20, 0));
    EXPECT_LT(found[1].shift.overlap, 0.9);
    EXPECT_GE(found[1].shift.overlap, found[2].shift.overlap);
}

// A room that is as similar to itself turned round is found both ways round.
TEST(PlaceIndex, FindsAPlaceAtSeveralHeadings) {
    const auto once = image(4, 60, 300);
    Eigen::Matrix2Xd cells(2, 600);
    cells << once.cells(), -once.cells();
    auto bands = once.bands();
    bands.insert(bands.end(), once.bands().begin(), once.bands().end());
    const HeightImage room(cells, std::move(bands), {}, {});
    PlaceIndex index;
    index.add(room);
    const auto found = index.find(room, 4);
    ASSERT_EQ(found.size(), 4U);
    EXPECT_EQ(found[0].shift.overlap, 1);
    EXPECT_EQ(found[0].shift.yaw, 0);
    EXPECT_NEAR(found[1].shift.yaw, M_PI, 1e-9);
    EXPECT_GT(found[1].shift.overlap, 0.9);
    EXPECT_LT(found[2].shift.overlap, 0.9);
}

TEST(PlaceIndex, SharesAreWhatCountingGives) {
    const auto place = image(7, 40, 60);
    PlaceIndex index;
    index.add(place);
    // The larger one lies beyond the edges of the place on all sides, and meets nothing there.
    for (const auto& seen : {image(8, 90, 200), image(9, 30, 40), moved(place, -1, {6, 8})}) {
        const auto found = index.find(seen, 1).at(0);
        EXPECT_NEAR(found.shift.overlap, mostOf(place, seen), 1e-12);
    }
}

// 110 x 110 cells of 2 m with six bands or more: more than 16 bits count.
TEST(PlaceIndex, OfAPlaceWithVeryManyBands) {
    Eigen::Matrix2Xd cells(2, 110 * 110);
    for (Eigen::Index i = 0; i < cells.cols(); ++i)
        cells.col(i) = Eigen::Vector2d(2.0 * static_cast<double>(i % 110) - 109.75,
                                       2.0 * static_cast<double>(i / 110) - 109.75);
    const HeightImage large(cells, std::vector<std::uint8_t>(110 * 110, 0xFF), {}, {});
    PlaceIndex index;
    index.add(large);
    const auto found = index.find(large, 1).at(0);
    EXPECT_EQ(found.shift.overlap, 1);
    EXPECT_LT(found.shift.translation.norm(), 1e-9);
}
}  // namespace
