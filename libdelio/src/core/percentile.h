#pragma once
#include <cstddef>
#include <vector>

namespace delio {
/** Percentile by nearest rank: the smallest of the values that at least `percent` % of them do not
 *  exceed. `sorted`: ascending, not empty; `percent`: 1 to 100. */
inline double percentileOf(const std::vector<double>& sorted, std::size_t percent) {
    return sorted[(percent * sorted.size() + 99) / 100 - 1];
}
}  // namespace delio
