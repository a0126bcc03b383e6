#include "odometry/range_image.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/portable_math.h"

namespace delio::odometry {
namespace {
constexpr int kEnough = 3;  // cells seen of a neighbourhood, to call it free
constexpr float kPerMetre = 100;
constexpr float kWidestGap = 3.0F * static_cast<float>(M_PI) / 180;  // between two rings

float rangeOf(float x, float y, float z) { return std::sqrt(x * x + (y * y + z * z)); }
}  // namespace

inline int RangeImage::Directions::rowOf(float x, float y, float z) const {
    const float elevation = approximateAtan2(z, std::sqrt(x * x + y * y));
    const int row = static_cast<int>((elevation + static_cast<float>(M_PI_2)) * perRadian);
    return std::clamp(row, 0, rows - 1);
}

inline int RangeImage::Directions::columnOf(float x, float y) const {
    const float azimuth = approximateAtan2(y, x) + static_cast<float>(M_PI);
    const int column = static_cast<int>(azimuth * perRadian);
    return column < columns ? column : column - columns;  // at most one turn
}

/** Cells, counted from the lowest row that there can be, and ranges of a few points. */
void RangeImage::Directions::see(const Eigen::Ref<const Eigen::Matrix3Xf>& points, int* cells,
                                 float* ranges) const {
    // Each coordinate in a row of its own, and a plain loop: vector instructions.
    const Eigen::Array<float, 3, Eigen::Dynamic, Eigen::RowMajor> axes = points.array();
    const float *xs = axes.data(), *ys = xs + axes.cols(), *zs = ys + axes.cols();
    const Directions our = *this;  // nothing that is written can change it
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const float x = xs[i], y = ys[i], z = zs[i];
        cells[i] = our.rowOf(x, y, z) * our.columns + our.columnOf(x, y);
        ranges[i] = rangeOf(x, y, z);
    }
}

RangeImage::RangeImage(const Eigen::Matrix3Xf& points, double cell_deg)
    : directions_{static_cast<float>(180 / M_PI / cell_deg),
                  static_cast<int>(std::lround(180 / cell_deg)),
                  static_cast<int>(std::lround(360 / cell_deg))} {
    if (points.cols() == 0) return;
    using Range = tbb::blocked_range<Eigen::Index>;
    Eigen::ArrayXi cells(points.cols());
    Eigen::ArrayXf ranges(points.cols());
    constexpr Eigen::Index kBlock = 1024;
    tbb::parallel_for(Range(0, points.cols(), kBlock), [&](const Range& block) {
        for (Eigen::Index first = block.begin(); first < block.end(); first += kBlock) {
            const Eigen::Index count = std::min(kBlock, block.end() - first);
            directions_.see(points.middleCols(first, count), cells.data() + first,
                            ranges.data() + first);
        }
    });
    const int columns = directions_.columns;
    firstRow_ = cells.minCoeff() / columns;
    // The least without a branch, which would be a guess for most of the points.
    constexpr float kNothing = std::numeric_limits<float>::infinity();
    nearest_.resize(cellOf(cells.maxCoeff() / columns + 1, 0), kNothing);
    const Eigen::Index before = Eigen::Index{firstRow_} * columns;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        float& nearest = nearest_[static_cast<std::size_t>(cells[i] - before)];
        nearest = std::min(nearest, ranges[i]);
    }
    for (float& nearest : nearest_) nearest = nearest < kNothing ? nearest : 0.0F;
    summarise();
}

RangeImage::RangeImage(const PackedRanges& packed, double cell_deg)
    : RangeImage(Eigen::Matrix3Xf(3, 0), cell_deg) {
    firstRow_ = packed.firstRow;
    nearest_.reserve(packed.ranges_cm.size());
    for (const auto range_cm : packed.ranges_cm)
        nearest_.push_back(static_cast<float>(range_cm) / kPerMetre);
    fillGaps();
    summarise();
}

PackedRanges RangeImage::packed() const {
    PackedRanges packed{firstRow_, {}};
    packed.ranges_cm.reserve(nearest_.size());
    constexpr float kMost = 65535;
    for (const float range : nearest_)
        packed.ranges_cm.push_back(
            static_cast<std::uint16_t>(std::min(std::round(range * kPerMetre), kMost)));
    return packed;
}

template <typename Visit>
void RangeImage::forNeighbours(int row, int column, const Visit& visit) const {
    const std::array<int, 3> columns = {column == 0 ? directions_.columns - 1 : column - 1, column,
                                        column + 1 == directions_.columns ? 0 : column + 1};
    const int last = firstRow_ + static_cast<int>(rows()) - 1;
    for (int r = std::max(row - 1, firstRow_); r <= std::min(row + 1, last); ++r)
        for (const int c : columns) {
            const float nearest = nearest_[cellOf(r, c)];
            if (nearest > 0) visit(nearest);
        }
}

/** Between two rings the nearer one counts. */
void RangeImage::fillGaps() {
    const int widest = static_cast<int>(kWidestGap * directions_.perRadian);
    const auto columns = static_cast<std::size_t>(directions_.columns);
    std::vector<std::size_t> gaps(static_cast<std::size_t>(widest) + 1);  // how many of each width
    for (std::size_t c = 0; c < columns; ++c) {
        int below = -1;  // the last row that saw something
        for (int r = 0; r < static_cast<int>(rows()); ++r) {
            const float range = nearest_[static_cast<std::size_t>(r) * columns + c];
            if (range == 0) continue;
            if (below >= 0 && r - below <= widest) {
                ++gaps[static_cast<std::size_t>(r - below)];
                for (int k = below + 1; k < r; ++k)
                    nearest_[static_cast<std::size_t>(k) * columns + c] =
                        std::min(range, nearest_[static_cast<std::size_t>(below) * columns + c]);
            }
            below = r;
        }
    }
    const auto all = std::accumulate(gaps.begin(), gaps.end(), std::size_t{0});
    std::size_t median = 0;
    for (std::size_t narrower = 0; median < gaps.size(); ++median)
        if ((narrower += gaps[median]) * 2 > all) break;
    ringSpacing_ = static_cast<float>(median) / directions_.perRadian;
}

void RangeImage::summarise() {
    constexpr float kNothing = std::numeric_limits<float>::infinity();
    const auto columns = static_cast<std::size_t>(directions_.columns);
    leastAbout_.resize(nearest_.size());
    // Of three rows first, with a column more on either side, then of three columns: plain loops.
    std::vector<float> least(columns + 2);
    std::vector<int> seen(columns + 2);
    for (std::size_t row = 0; row < rows(); ++row) {
        std::fill(least.begin(), least.end(), kNothing);
        std::fill(seen.begin(), seen.end(), 0);
        for (std::size_t r = row - (row > 0); r < std::min(row + 2, rows()); ++r) {
            const float* const nearest = nearest_.data() + r * columns;
            for (std::size_t c = 0; c < columns; ++c) {
                const bool isSeen = nearest[c] > 0;
                least[c + 1] = std::min(least[c + 1], isSeen ? nearest[c] : kNothing);
                seen[c + 1] += isSeen;
            }
        }
        least.front() = least[columns];
        seen.front() = seen[columns];
        least.back() = least[1];
        seen.back() = seen[1];
        float* const about = leastAbout_.data() + row * columns;
        for (std::size_t c = 0; c < columns; ++c) {
            const float all = std::min(std::min(least[c], least[c + 1]), least[c + 2]);
            const int count = seen[c] + seen[c + 1] + seen[c + 2];
            about[c] = count >= kEnough ? all : count > 0 ? -all : 0.0F;
        }
    }
}

Place RangeImage::lookAbout(int row, int column, float range, float margin) const {
    int seen = 0, passed = 0;
    bool taken = false;
    forNeighbours(row, column, [&](float nearest) {
        taken = taken || std::abs(nearest - range) <= margin;
        ++seen;
        passed += nearest > range;
    });
    if (taken) return Place::kTaken;
    return seen >= kEnough && passed == seen ? Place::kFree : Place::kUnknown;
}

Place RangeImage::at(const Eigen::Vector3f& point, float margin) const {
    const float x = point.x(), y = point.y(), z = point.z();
    const float range = rangeOf(x, y, z);
    const int row = directions_.rowOf(x, y, z), column = directions_.columnOf(x, y);
    const int r = row - firstRow_;
    if (r < 0 || r >= static_cast<int>(rows())) return lookAbout(row, column, range, margin);
    // Mostly the minimum of the neighbourhood decides.
    const float about = leastAbout_[cellOf(row, column)];
    if (about == 0) return Place::kUnknown;
    const float farther = std::abs(about) - range;
    if (farther > margin) return about > 0 ? Place::kFree : Place::kUnknown;
    if (farther >= -margin) return Place::kTaken;
    return lookAbout(row, column, range, margin);
}
}  // namespace delio::odometry
