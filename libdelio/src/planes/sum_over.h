#pragma once
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <cstddef>

#include "delio/planes/correspondence.h"

namespace delio::planes {
/** addOne(match, sum) for each correspondence. Parts of them are summed side by side and come
 *  together as their number alone says: the same bytes for any number of threads.
 *  @tparam Sum is nothing where it is made, and has += */
template <typename Sum, typename AddOne>
Sum sumOver(const Correspondences& matches, const AddOne& addOne) {
    using Range = tbb::blocked_range<std::size_t>;
    constexpr std::size_t kPart = 512;
    return tbb::parallel_deterministic_reduce(
        Range(0, matches.size(), kPart), Sum(),
        [&](const Range& range, Sum sum) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) addOne(matches[i], sum);
            return sum;
        },
        [](Sum sum, const Sum& other) {
            sum += other;
            return sum;
        });
}
}  // namespace delio::planes
