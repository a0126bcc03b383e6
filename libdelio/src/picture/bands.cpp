#include "bands.h"

#include <algorithm>

namespace delio::picture {
namespace {
unsigned even(unsigned rows) { return rows / 2 * 2; }

/** So few that the memory is small beside the rest: a pixel of them for two points of the scene. */
unsigned rowsOfBand(unsigned width, unsigned height, unsigned margin, std::size_t scenePoints) {
    constexpr std::size_t kSmall = 1 << 18, kMost = std::size_t{1} << 31;  // pixels
    constexpr unsigned kMostBands = 32;
    const auto pixels = static_cast<unsigned>(std::clamp(scenePoints / 2, kSmall, kMost));
    const unsigned wanted = std::max(height / kMostBands, std::min(height, pixels / width));
    return std::min(height, even(wanted) + 2 + 2 * margin);
}
}  // namespace

Bands::Bands(unsigned width, unsigned height, unsigned margin, std::size_t scenePoints)
    : rows(rowsOfBand(width, height, margin, scenePoints)) {
    for (unsigned begin = 0; begin < height; begin = all.back().end) {
        const unsigned first = std::min(begin - std::min(begin, margin), height - rows);
        const bool isLast = first + rows == height;
        all.push_back({first, begin, isLast ? height : first + rows - margin});
    }
}
}  // namespace delio::picture
