#include "delio/loops/height_image.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "bands.h"
#include "core/voxel_grid.h"

namespace delio::loops {
namespace {
constexpr double kBlock_m = 4;  // of one height of the ground
constexpr double kGround_m = 0.3;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::uint64_t keyAt(double x, double y, double size) {
    return voxelKey(floorOf(x / size), floorOf(y / size), 0);
}

/** One bit for each of 0.3 to 1, 2, 4, 8 m and more above the ground. */
std::uint8_t bandOf(double height) {
    if (height < kGround_m) return 0;
    std::uint8_t band = 1;
    for (double top = 1; height >= top && top <= 8; top *= 2)
        band = static_cast<std::uint8_t>(2 * band);
    return band;
}

unsigned totalOf(const std::vector<std::uint8_t>& bands) {
    unsigned total = 0;
    for (const auto cell : bands) total += bitsOf(cell);
    return total;
}

/** The image's cells in memory as they lie, with a margin of nothing. */
class Raster {
 public:
    Raster(const HeightImage& image, Eigen::Index margin) {
        const auto cells = image.cells();
        if (cells.cols() == 0) return;
        const Eigen::Vector2d low = cells.rowwise().minCoeff(), high = cells.rowwise().maxCoeff();
        x0_ = indexOf(low.x()) - margin;
        y0_ = indexOf(low.y()) - margin;
        width_ = indexOf(high.x()) + margin + 1 - x0_;
        height_ = indexOf(high.y()) + margin + 1 - y0_;
        bands_.assign(static_cast<std::size_t>(width_ * height_), 0);
        for (Eigen::Index i = 0; i < cells.cols(); ++i)
            bands_[static_cast<std::size_t>((indexOf(cells(1, i)) - y0_) * width_ +
                                            indexOf(cells(0, i)) - x0_)] =
                image.bands()[static_cast<std::size_t>(i)];
    }
    static Eigen::Index indexOf(double metres) {
        return static_cast<Eigen::Index>(std::floor(metres / HeightImage::kCell_m));
    }
    /** `count` cells of the row y from x on; null where they are not all there. */
    const std::uint8_t* row(Eigen::Index x, Eigen::Index y, Eigen::Index count) const {
        x -= x0_;
        y -= y0_;
        if (x < 0 || y < 0 || y >= height_ || x + count > width_) return nullptr;
        return bands_.data() + y * width_ + x;
    }

 private:
    Eigen::Index x0_ = 0, y0_ = 0, width_ = 0, height_ = 0;
    std::vector<std::uint8_t> bands_;
};

using Scores = Eigen::Matrix<unsigned, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/** Of all shifts by whole cells about (x0, y0): how many bits of both images meet. */
Scores correlated(const HeightImage& image, const Eigen::Matrix2Xd& cells,
                  const std::vector<std::uint8_t>& bands, const Eigen::Vector2d& expected,
                  Eigen::Index reach) {
    const Eigen::Index side = 2 * reach + 1;
    const Raster raster(image, side);
    Scores scores = Scores::Zero(side, side);
    tbb::parallel_for(Eigen::Index{0}, side, [&](Eigen::Index dy) {
        for (Eigen::Index i = 0; i < cells.cols(); ++i) {
            const Eigen::Vector2d centre = cells.col(i) + expected;
            const auto* row = raster.row(Raster::indexOf(centre.x()) - reach,
                                         Raster::indexOf(centre.y()) - reach + dy, side);
            if (!row) continue;
            const std::uint8_t mine = bands[static_cast<std::size_t>(i)];
            unsigned* sums = &scores(dy, 0);
            for (Eigen::Index dx = 0; dx < side; ++dx)
                sums[dx] += bitsOf(static_cast<std::uint8_t>(mine & row[dx]));
        }
    });
    return scores;
}

/** The best ones, `apart` cells from each other at least. */
std::vector<Eigen::Vector2i> peaksOf(Scores scores, int apart, std::size_t most) {
    std::vector<Eigen::Vector2i> peaks;
    while (peaks.size() < most) {
        Eigen::Index y = 0, x = 0;
        if (scores.size() == 0 || scores.maxCoeff(&y, &x) == 0) break;
        peaks.emplace_back(static_cast<int>(x), static_cast<int>(y));
        const Eigen::Index left = std::max<Eigen::Index>(0, x - apart),
                           top = std::max<Eigen::Index>(0, y - apart);
        scores
            .block(top, left, std::min(scores.rows(), y + apart + 1) - top,
                   std::min(scores.cols(), x + apart + 1) - left)
            .setZero();
    }
    return peaks;
}

double median(std::vector<double>& values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}
/** By how much the other's ground lies below this one's where both were seen. */
double lift(const HeightImage& image, const HeightImage& other, const Eigen::Isometry2d& shift) {
    std::vector<double> differences;
    for (Eigen::Index i = 0; i < other.grounds().cols(); ++i) {
        const Eigen::Vector2d there = other.grounds().col(i), here = shift * there;
        const double difference =
            image.groundAt(here.x(), here.y()) - other.groundAt(there.x(), there.y());
        if (std::isfinite(difference)) differences.push_back(difference);
    }
    return median(differences);
}

/** The height under nearly all: the tenth part, which false echoes do not reach. */
double lowest(std::vector<float>& heights) {
    const auto tenth = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 10);
    std::nth_element(heights.begin(), tenth, heights.end());
    return static_cast<double>(*tenth);
}

Eigen::Matrix<std::int16_t, 2, Eigen::Dynamic> halvesOf(const Eigen::Matrix2Xd& centres) {
    return (centres * 2 / HeightImage::kCell_m).array().round().cast<std::int16_t>();
}
}  // namespace

HeightImage::HeightImage(const Eigen::Matrix3Xf& points) {
    std::vector<std::vector<float>> blocks;
    std::vector<Eigen::Vector2d> centres;
    const auto centreOf = [](float value, double size) {
        return (std::floor(static_cast<double>(value) / size) + 0.5) * size;
    };
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const auto p = points.col(i);
        const auto number = groundIndex_.insert(keyAt(p.x(), p.y(), kBlock_m));
        if (number == blocks.size()) {
            blocks.emplace_back();
            centres.emplace_back(centreOf(p.x(), kBlock_m), centreOf(p.y(), kBlock_m));
        }
        blocks[number].push_back(p.z());
    }
    grounds_.resize(2, static_cast<Eigen::Index>(blocks.size()));
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        grounds_.col(static_cast<Eigen::Index>(i)) = centres[i];
        heights_.push_back(lowest(blocks[i]));
    }
    centres.clear();
    VoxelIndex cells;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const auto p = points.col(i);
        const auto band = bandOf(static_cast<double>(p.z()) - groundAt(p.x(), p.y()));
        if (band == 0) continue;
        const auto number = cells.insert(keyAt(p.x(), p.y(), kCell_m));
        if (number == bands_.size()) {
            bands_.push_back(0);
            centres.emplace_back(centreOf(p.x(), kCell_m), centreOf(p.y(), kCell_m));
        }
        bands_[number] = static_cast<std::uint8_t>(bands_[number] | band);
    }
    Eigen::Matrix2Xd all(2, static_cast<Eigen::Index>(centres.size()));
    for (std::size_t i = 0; i < centres.size(); ++i)
        all.col(static_cast<Eigen::Index>(i)) = centres[i];
    halves_ = halvesOf(all);
    bands_.shrink_to_fit();
}

HeightImage::HeightImage(const Eigen::Matrix2Xd& cells, std::vector<std::uint8_t> bands,
                         Eigen::Matrix2Xd grounds, std::vector<double> heights)
    : halves_(halvesOf(cells)),
      grounds_(std::move(grounds)),
      bands_(std::move(bands)),
      heights_(std::move(heights)) {
    for (Eigen::Index i = 0; i < grounds_.cols(); ++i)
        groundIndex_.insert(keyAt(grounds_(0, i), grounds_(1, i), kBlock_m));
}

Eigen::Matrix3Xd aboveGround(const Eigen::Matrix3Xf& points) {
    const HeightImage image(points);
    Eigen::Matrix3Xd above(3, points.cols());
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const Eigen::Vector3d point = points.col(i).cast<double>();
        if (point.z() - image.groundAt(point.x(), point.y()) > kGround_m)
            above.col(count++) = point;
    }
    above.conservativeResize(3, count);
    return above;
}

double HeightImage::groundAt(double x, double y) const {
    const auto number = groundIndex_.find(keyAt(x, y, kBlock_m));
    return number == VoxelIndex::kNone ? kNone : heights_[number];
}

std::vector<Shift> shiftsOf(const HeightImage& image, const HeightImage& other, double yaw,
                            const Eigen::Vector2d& expected, double reach, double apart,
                            std::size_t most) {
    const auto cellsOf = [](double metres) {
        return static_cast<Eigen::Index>(std::ceil(metres / HeightImage::kCell_m));
    };
    const Eigen::Rotation2Dd turn(yaw);
    const Eigen::Matrix2Xd turned = turn.toRotationMatrix() * other.cells();
    const auto scores = correlated(image, turned, other.bands(), expected, cellsOf(reach));
    const unsigned total = std::max(1U, std::min(totalOf(image.bands()), totalOf(other.bands())));
    std::vector<Shift> shifts;
    for (const auto& peak : peaksOf(scores, static_cast<int>(cellsOf(apart)), most)) {
        const Eigen::Vector2d moved =
            expected +
            HeightImage::kCell_m *
                (peak.cast<double>().array() - static_cast<double>(cellsOf(reach))).matrix();
        const Eigen::Isometry2d there = Eigen::Translation2d(moved) * turn;
        const double share = static_cast<double>(scores(peak.y(), peak.x())) / total;
        shifts.push_back(
            {yaw, {moved.x(), moved.y(), lift(image, other, there)}, std::min(1.0, share)});
    }
    return shifts;
}
}  // namespace delio::loops
