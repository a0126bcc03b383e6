#include "core/voxel_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/voxel_grid.h"
#include "ring_scan.h"

namespace delio::odometry {
namespace {
constexpr std::int64_t kSide = 20;

/** A cube of voxels about the origin: neighbours, whose keys differ by little. */
template <typename Visit>
void forCube(const Visit& visit) {
    for (std::int64_t x = -kSide; x < kSide; ++x)
        for (std::int64_t y = -kSide; y < kSide; ++y)
            for (std::int64_t z = -kSide; z < kSide; ++z) visit(voxelKey(x, y, z));
}

TEST(VoxelIndex, NumbersInTheOrderInWhichKeysCome) {
    VoxelIndex index;
    std::uint32_t next = 0;
    forCube([&](std::uint64_t key) { EXPECT_EQ(index.insert(key), next++); });
    EXPECT_EQ(index.size(), next);
    next = 0;
    forCube([&](std::uint64_t key) {
        EXPECT_EQ(index.find(key), next);
        EXPECT_EQ(index.insert(key), next++);
    });
    EXPECT_EQ(index.find(voxelKey(kSide, 0, 0)), VoxelIndex::kNone);
}

TEST(VoxelIndex, IsEmptyAtFirstAndOnceCleared) {
    VoxelIndex index;
    EXPECT_EQ(index.find(0), VoxelIndex::kNone);
    index.insert(0);
    index.clear();
    EXPECT_EQ(index.find(0), VoxelIndex::kNone);
    EXPECT_EQ(index.size(), 0U);
}

TEST(VoxelIndex, FindsTheRestWhenSomeAreErased) {
    VoxelIndex index;
    std::vector<std::uint64_t> keys;
    forCube([&](std::uint64_t key) {
        index.insert(key);
        keys.push_back(key);
    });
    // In an order of chance, down to the last one.
    for (std::size_t next = 7; !keys.empty(); next = next * 31 + 11) {
        const std::size_t gone = next % keys.size();
        index.erase(keys[gone], keys.back());
        ASSERT_EQ(index.find(keys[gone]), VoxelIndex::kNone);
        keys[gone] = keys.back();
        keys.pop_back();
        ASSERT_EQ(index.size(), keys.size());
        if (keys.size() % 1000 != 0) continue;
        for (std::uint32_t i = 0; i < keys.size(); ++i) ASSERT_EQ(index.find(keys[i]), i);
    }
}

TEST(VoxelTable, KeepsTheRestWhenSomeAreErased) {
    VoxelTable<std::uint64_t> table;
    std::vector<std::uint64_t> beside;  // what is kept by the values' numbers
    forCube([&](std::uint64_t key) {
        table[table.insert(key)] = key;
        beside.push_back(key);
    });
    const auto all = table.size();
    const auto isOdd = [](std::uint64_t key) { return key % 2 == 1; };
    table.eraseIf(
        [&](std::uint64_t key, std::uint64_t value) { return isOdd(key) && isOdd(value); },
        [&](std::uint32_t from, std::uint32_t to) { beside[to] = beside[from]; });
    EXPECT_EQ(table.size(), all / 2);
    forCube([&](std::uint64_t key) {
        const auto* found = table.find(key);
        ASSERT_EQ(found == nullptr, isOdd(key));
        if (found) {
            EXPECT_EQ(*found, key);
            EXPECT_EQ(beside[table.numberOf(key)], key);
        }
    });
    // What was erased can come again.
    const std::uint64_t odd = voxelKey(0, 0, 1);
    table[table.insert(odd)] = 7;
    ASSERT_NE(table.find(odd), nullptr);
    EXPECT_EQ(*table.find(odd), 7U);
}

TEST(VoxelKey, IsTheSameByNumbersAndByPoint) {
    EXPECT_EQ(voxelKey({-0.1, 0.1, 1.2}, 0.5), voxelKey(-1, 0, 2));
    EXPECT_EQ(voxelKey({-0.5, 0.5, -1.2}, 0.5), voxelKey(-1, 1, -3));
}

TEST(VoxelKey, OfALargerVoxelFollows) {
    test::Noise noise;
    for (int i = 0; i < 1000; ++i) {
        const Eigen::Vector3d a = 20 * noise.normals(), b = a + noise.normals();
        for (unsigned level = 0; level < 6; ++level) {
            const double large = 0.5 * std::pow(2, level);
            EXPECT_EQ(coarserKey(voxelKey(a, 0.5), level) == coarserKey(voxelKey(b, 0.5), level),
                      voxelKey(a, large) == voxelKey(b, large));
        }
    }
}

constexpr double kSize = 0.5, kRadius = 20;

TEST(VoxelBall, HoldsNoVoxelOfAPointOutside) {
    test::Noise noise;
    // Far from the origin, and beyond where keys begin anew.
    for (const double away : {0.0, 4000.0, -0.5 * (1 << 20) * kSize - 3}) {
        const Eigen::Vector3d centre(away, -away, 7.3);
        for (unsigned levels = 0; levels < 5; ++levels) {
            const VoxelBall ball(centre, kRadius, kSize, levels);
            int held = 0, inside = 0;
            for (int i = 0; i < 20000; ++i) {
                const Eigen::Vector3d offset = 2 * kRadius * noise.uniform() * noise.direction();
                const auto key = coarserKey(voxelKey(centre + offset, kSize), levels);
                held += ball.holds(key);
                if (offset.norm() > kRadius) {
                    EXPECT_FALSE(ball.holds(key)) << offset.transpose();
                    continue;
                }
                ++inside;
            }
            // Of the smallest voxels nearly all.
            EXPECT_GT(held, (levels == 0 ? 0.85 : 0.1) * inside) << levels;
        }
    }
}

TEST(VoxelBall, HoldsNothingWhereItIsSmallerThanAVoxel) {
    const Eigen::Vector3d centre(0.25, 0.25, 0.25);
    EXPECT_FALSE(VoxelBall(centre, 0.2, kSize).holds(voxelKey(centre, kSize)));
    EXPECT_TRUE(VoxelBall(centre, 2, kSize).holds(voxelKey(centre, kSize)));
}
}  // namespace
}  // namespace delio::odometry
