#include "band_viewports.h"

#include <cmath>

namespace delio::picture {
namespace {
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
