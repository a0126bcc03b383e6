#include "core/chunked.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <vector>

namespace {
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
