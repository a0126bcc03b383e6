#include "core/chunked.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace {
using delio::Chunked;

TEST(Chunked, HoldsWhatWasPutIn) {
    constexpr std::size_t kCount = 5000;
    Chunked<std::string> all;
    for (std::size_t i = 0; i < kCount; ++i) all.push_back(std::to_string(i));
    ASSERT_EQ(all.size(), kCount);
    for (std::size_t i = 0; i < kCount; ++i) EXPECT_EQ(all[i], std::to_string(i));
}

TEST(Chunked, DoesNotMoveWhatItHolds) {
    Chunked<int> all;
    all.push_back(7);
    const int* first = &all[0];
    for (int i = 0; i < 100'000; ++i) all.push_back(i);
    EXPECT_EQ(&all[0], first);
    EXPECT_EQ(*first, 7);
}

TEST(Chunked, ShrinksAndGrowsAgainAcrossItsChunks) {
    Chunked<std::string> all;
    for (const std::size_t size : {20000U, 1000U, 1024U, 1025U, 0U, 5000U}) {
        const std::size_t before = all.size();
        all.resize(size);
        ASSERT_EQ(all.size(), size);
        for (std::size_t i = before; i < size; ++i) {
            EXPECT_EQ(all[i], "");
            all[i] = std::to_string(i);
        }
        for (std::size_t i = 0; i < size; ++i) ASSERT_EQ(all[i], std::to_string(i));
    }
    Chunked<std::string> taken = std::move(all), copy = taken;
    EXPECT_EQ(copy.size(), 5000U);
    EXPECT_EQ(copy[4999], "4999");
}

TEST(Chunked, NewOnesAreNotWhatWasTakenAway) {
    Chunked<std::string> all;
    for (int i = 0; i < 10; ++i) all.push_back("old");
    all.resize(3);
    all.push_back({});
    EXPECT_EQ(all.size(), 4U);
    EXPECT_EQ(all[2], "old");
    EXPECT_EQ(all[3], "");
}

using namespace delio;

TEST(LargeMemory, IsThereAndAlignedForEverySize) {
    for (const std::size_t bytes : {1UL, 100UL, 2UL << 20, (2UL << 20) + 1, 9UL << 20}) {
        const auto memory = largeMemory(bytes);
        ASSERT_TRUE(memory);
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(memory.get()) % 64, 0U) << bytes;
        std::memset(memory.get(), 1, bytes);
    }
}

TEST(LargeMemory, HoldsAVectorThatGrows) {
    std::vector<std::uint64_t, LargeAllocator<std::uint64_t>> all;
    for (std::uint64_t i = 0; i < 1'000'000; ++i) all.push_back(i);
    const auto copy = all;
    for (std::uint64_t i = 0; i < all.size(); ++i) ASSERT_EQ(copy[i], i);
}
}  // namespace
