#include "eye_dome.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "delio/core/error.h"
#include "marks.h"

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

/** Eight directions, at one and at two radii. */
std::array<Offset, 16> neighbours(double radius_px) {
    std::array<Offset, 16> offsets{};
    for (std::size_t i = 0; i < offsets.size(); ++i) {
        const double radius = std::max(radius_px, 1.0) * (i < 8 ? 1 : 2);
        const double angle = M_PI / 4 * static_cast<double>(i % 8);
        offsets[i] = {static_cast<int>(std::lround(radius * std::cos(angle))),
                      static_cast<int>(std::lround(radius * std::sin(angle)))};
    }
    return offsets;
}
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
    const double marks = sizeOfMarks(options);
    EyeDome shading;
    shading.radius_px = marks * enlarged;
    // In small pictures a radius is a wider angle, across which slopes make larger differences.
    shading.gain *= options.shading * std::min(1.0, options.height_px / (1080 * marks));
    return shading;
}

void shadeEyeDome(CImage& image, const CMatrixFloat& logDepth, const EyeDome& shading) {
    const int width = static_cast<int>(image.getWidth());
    const int height = static_cast<int>(image.getHeight());
    if (logDepth.cols() != width || logDepth.rows() != height)
        throw Error("a picture cannot be shaded by a depth of another size");
    if (shading.gain <= 0) return;
    const auto offsets = neighbours(shading.radius_px);
    const auto scale = static_cast<float>(shading.gain / static_cast<double>(offsets.size()));
    forEachRow(height, [&](int row) {
        for (int column = 0; column < width; ++column) {
            const float own = logDepth(row, column);
            if (own == kBehindAll) continue;
            float nearer = 0;
            for (const auto& offset : offsets) {
                const int x = column + offset.column, y = row + offset.row;
                if (x >= 0 && x < width && y >= 0 && y < height)
                    nearer += std::max(0.0F, own - logDepth(y, x));
            }
            if (nearer == 0) continue;
            const float light = std::exp(-scale * nearer);
            auto* bgr =
                image.ptr<std::uint8_t>(static_cast<unsigned>(column), static_cast<unsigned>(row));
            for (int i = 0; i < 3; ++i)
                bgr[i] = static_cast<std::uint8_t>(std::lround(light * static_cast<float>(bgr[i])));
        }
    });
}
}  // namespace delio::picture
