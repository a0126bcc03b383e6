#include "core/percentile.h"

#include <gtest/gtest.h>

namespace {
using delio::percentileOf;

/** By definition: the least of the values that at least so many percent do not exceed. */
TEST(Percentile, IsThatOfTheNearestRank) {
    for (std::size_t count = 1; count <= 45; ++count) {
        std::vector<double> values;
        while (values.size() < count) values.push_back(static_cast<double>(values.size()));
        for (const std::size_t percent : {1U, 5U, 50U, 95U, 99U, 100U}) {
            std::size_t rank = 1;
            while (100 * rank < percent * count) ++rank;
            EXPECT_EQ(percentileOf(values, percent), values[rank - 1]) << count << " " << percent;
        }
    }
}

TEST(Percentile, OfFewValuesIsNotBelowTheirMean) {
    EXPECT_EQ(percentileOf({45.1, 60.6}, 95), 60.6);
    EXPECT_EQ(percentileOf({7}, 95), 7);
    EXPECT_EQ(percentileOf({1, 2, 3, 4}, 50), 2);
}
}  // namespace
