#include "picture/shading.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "delio/core/error.h"
#include "picture/view.h"

namespace delio::picture {
using mrpt::img::CImage;
using mrpt::math::CMatrixFloat;

namespace {
constexpr float kBehindAll = std::numeric_limits<float>::infinity();

template <typename Work>
void forEachRow(int rows, const Work& work) {
    tbb::parallel_for(0, rows, work);
}

struct Offset {
    int column, row;
};

/** Four of eight directions, the others are opposite, at one and then at two radii. */
std::array<Offset, 8> halfOfNeighbours(double radius_px) {
    std::array<Offset, 8> offsets{};
    for (std::size_t i = 0; i < offsets.size(); ++i) {
        const double radius = std::max(radius_px, 1.0) * (i < 4 ? 1 : 2);
        const double angle = M_PI / 4 * static_cast<double>(i % 4);
        offsets[i] = {static_cast<int>(std::lround(radius * std::cos(angle))),
                      static_cast<int>(std::lround(radius * std::sin(angle)))};
    }
    return offsets;
}

/** How much nearer two opposite neighbours are, beyond what a slope explains. */
float nearness(float own, float one, float other, float slope) {
    const float nearer = own - std::min(one, other), farther = std::max(one, other) - own;
    if (nearer <= 0) return 0;
    if (farther == kBehindAll) return nearer;
    return std::max(0.0F, nearer - std::min(farther, slope));
}

/** The depths around a pixel. Of two neighbours of which one is outside the picture, none counts.
 */
struct Surroundings {
    Surroundings(const CMatrixFloat& logDepth, const EyeDome& shading)
        : depth(logDepth),
          offsets(halfOfNeighbours(shading.radius_px)),
          slope(static_cast<float>(shading.slope)) {}

    bool inside(int column, int row) const {
        return column >= 0 && column < depth.cols() && row >= 0 && row < depth.rows();
    }
    float meanNearness(int column, int row) const {
        const float own = depth(row, column);
        float sum = 0;
        for (std::size_t i = 0; i < offsets.size(); ++i) {
            const auto [x, y] = offsets[i];
            if (!inside(column + x, row + y) || !inside(column - x, row - y)) continue;
            sum += nearness(own, depth(row + y, column + x), depth(row - y, column - x),
                            i < offsets.size() / 2 ? slope : 2 * slope);
        }
        return sum / static_cast<float>(2 * offsets.size());
    }

    const CMatrixFloat& depth;
    std::array<Offset, 8> offsets;
    float slope;
};
}  // namespace

void toLogDepth(CMatrixFloat& depth, const View& view, const SnapshotOptions& options) {
    const auto nearClip = static_cast<double>(nearClipOf(view)), farClip = view.farthest;
    const double distance = distanceOf(view, options);
    forEachRow(static_cast<int>(depth.rows()), [&](int row) {
        for (int column = 0; column < static_cast<int>(depth.cols()); ++column) {
            float& d = depth(row, column);
            if (d == kNoDepth)
                d = kBehindAll;
            else if (options.ortho) {
                // MRPT takes every projection for a perspective one: undo that.
                const double metres = nearClip + farClip - nearClip * farClip / double{d};
                d = static_cast<float>(metres / distance * M_LOG2E);
            } else
                d = std::log2(d);
        }
    });
}

EyeDome eyeDomeOf(const SnapshotOptions& options, unsigned enlarged) {
    const double marks = sizeOfPoints(options);
    EyeDome shading;
    shading.radius_px = marks * enlarged;
    // In small pictures a radius is a wider angle, across which slopes make larger differences.
    constexpr double kSteepest = 5;  // tangent of the angle to the picture's plane
    const double pixel = 2 * std::tan(kVerticalView_deg * M_PI / 360) / options.height_px;
    shading.slope = kSteepest * marks * pixel * M_LOG2E;
    shading.gain *= options.shading * std::min(1.0, options.height_px / (1080 * marks));
    return shading;
}

unsigned reachOf(const EyeDome& shading) {
    return 2 * static_cast<unsigned>(std::ceil(std::max(shading.radius_px, 1.0)));
}

void shadeEyeDome(CImage& image, const CMatrixFloat& logDepth, const EyeDome& shading) {
    const int width = static_cast<int>(image.getWidth());
    const int height = static_cast<int>(image.getHeight());
    if (logDepth.cols() != width || logDepth.rows() != height)
        throw Error("a picture cannot be shaded by a depth of another size");
    if (shading.gain <= 0) return;
    const Surroundings around(logDepth, shading);
    const auto gain = static_cast<float>(shading.gain);
    forEachRow(height, [&](int row) {
        for (int column = 0; column < width; ++column) {
            if (logDepth(row, column) == kBehindAll) continue;
            const float nearness = around.meanNearness(column, row);
            if (nearness == 0) continue;
            const float light = std::exp(-gain * nearness);
            auto* bgr =
                image.ptr<std::uint8_t>(static_cast<unsigned>(column), static_cast<unsigned>(row));
            for (int i = 0; i < 3; ++i)
                bgr[i] = static_cast<std::uint8_t>(std::lround(light * static_cast<float>(bgr[i])));
        }
    });
}
}  // namespace delio::picture
