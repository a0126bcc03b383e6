#include "bands.h"

#include <algorithm>

namespace delio::picture {
namespace {
unsigned even(unsigned rows) { return rows / 2 * 2; }

/** So many that the memory is small beside the rest, but no more: each draws the whole scene. */
unsigned rowsOfBand(unsigned width, unsigned height, unsigned margin) {
    constexpr unsigned kMostBands = 32, kSmall = 1 << 18;  // pixels
    const unsigned wanted = std::max(height / kMostBands, kSmall / width);
    return std::min(height, even(wanted) + 2 + 2 * margin);
}
}  // namespace

Bands::Bands(unsigned width, unsigned height, unsigned margin)
    : rows(rowsOfBand(width, height, margin)) {
    for (unsigned begin = 0; begin < height; begin = all.back().end) {
        const unsigned first = std::min(begin - std::min(begin, margin), height - rows);
        const bool isLast = first + rows == height;
        all.push_back({first, begin, isLast ? height : first + rows - margin});
    }
}
}  // namespace delio::picture
