#include "delio/scan/range_image.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "delio/core/approximate_atan2.h"

namespace delio::scan {
RangeImage::RangeImage(const Eigen::Matrix3Xf& points, double cell_deg)
    : perRadian_(static_cast<float>(180 / M_PI / cell_deg)),
      rows_(static_cast<int>(std::lround(180 / cell_deg))),
      columns_(static_cast<int>(std::lround(360 / cell_deg))),
      nearest_(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_)) {
    struct Beam {
        std::int32_t cell;
        float range;
    };
    std::vector<Beam> beams(static_cast<std::size_t>(points.cols()));
    tbb::parallel_for(Eigen::Index{0}, points.cols(), [&](Eigen::Index i) {
        const Eigen::Vector3f point = points.col(i);
        beams[static_cast<std::size_t>(i)] = {rowOf(point) * columns_ + columnOf(point),
                                              point.norm()};
    });
    for (const Beam& beam : beams) {
        float& nearest = nearest_[static_cast<std::size_t>(beam.cell)];
        if (nearest == 0 || beam.range < nearest) nearest = beam.range;
    }
}

int RangeImage::rowOf(const Eigen::Vector3f& point) const {
    const float elevation = approximateAtan2(point.z(), point.head<2>().norm());
    const int row = static_cast<int>((elevation + static_cast<float>(M_PI_2)) * perRadian_);
    return std::clamp(row, 0, rows_ - 1);
}

int RangeImage::columnOf(const Eigen::Vector3f& point) const {
    const float azimuth = approximateAtan2(point.y(), point.x()) + static_cast<float>(M_PI);
    return static_cast<int>(azimuth * perRadian_) % columns_;
}

Place RangeImage::at(const Eigen::Vector3f& point, float margin) const {
    const float range = point.norm();
    const int row = rowOf(point), column = columnOf(point);
    const std::array<int, 3> columns = {column == 0 ? columns_ - 1 : column - 1, column,
                                        column + 1 == columns_ ? 0 : column + 1};
    int seen = 0, passed = 0;
    for (int r = std::max(row - 1, 0); r <= std::min(row + 1, rows_ - 1); ++r)
        for (const int c : columns) {
            const int cell = r * columns_ + c;
            const float nearest = nearest_[static_cast<std::size_t>(cell)];
            if (nearest == 0) continue;
            if (std::abs(nearest - range) <= margin) return Place::kTaken;
            ++seen;
            passed += nearest > range;
        }
    constexpr int kEnough = 3;
    return seen >= kEnough && passed == seen ? Place::kFree : Place::kUnknown;
}
}  // namespace delio::scan
