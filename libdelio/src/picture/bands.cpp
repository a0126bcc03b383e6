#include "picture/bands.h"

#include <algorithm>
#include <cmath>

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

/** Pixels, of what MRPT takes for a share of the whole up to 1, and below 0 counts from its other
 *  end. */
int pixelsOf(double value, int whole) {
    const double size = std::abs(value);
    return static_cast<int>(size > 1 ? size : whole * size);
}

int bottomOf(double y, int whole) {
    return y < 0 ? whole - pixelsOf(y, whole) : pixelsOf(y, whole);
}

/** What MRPT takes for so many pixels: 1 would be the whole, and it takes no 0. */
double sizeInPixels(int pixels) {
    if (pixels > 1) return pixels;
    return pixels == 1 ? 1.5 : 1e-9;
}

double placeInPixels(int pixels, int whole) {
    return pixels < 0 ? pixels - whole : sizeInPixels(pixels);
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

BandViewports::BandViewports(mrpt::opengl::COpenGLScene& scene, unsigned height, unsigned rows)
    : pictureHeight_(static_cast<int>(height)), rows_(static_cast<int>(rows)) {
    for (const auto& viewport : scene.viewports()) {
        Place place{viewport, 0, 0, 0, 0, 0, 0};
        viewport->getViewportPosition(place.x, place.y, place.width, place.height);
        place.bottom_px = bottomOf(place.y, pictureHeight_);
        place.height_px = pixelsOf(place.height, pictureHeight_);
        places_.push_back(place);
    }
}

BandViewports::~BandViewports() {
    for (const auto& place : places_)
        place.viewport->setViewportPosition(place.x, place.y, place.width, place.height);
}

void BandViewports::show(unsigned first) {
    const int below = pictureHeight_ - static_cast<int>(first) - rows_;
    for (const auto& place : places_)
        place.viewport->setViewportPosition(place.x, placeInPixels(place.bottom_px - below, rows_),
                                            place.width, sizeInPixels(place.height_px));
}
}  // namespace delio::picture
