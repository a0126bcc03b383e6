#include "places/descriptor.h"

#include <tbb/parallel_for.h>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/portable_math.h"
#include "core/voxel_grid.h"
#include "odometry/plane_map.h"

namespace delio::places {
namespace {
constexpr Eigen::Index kBins = WallOrientations::kBins;
constexpr double kWidth = M_PI / kBins;

Eigen::Index wrapped(Eigen::Index bin) { return ((bin % kBins) + kBins) % kBins; }

/** Circular, with a Gaussian of 1 deg: what a wall's normals scatter. */
Eigen::VectorXd smoothed(const Eigen::VectorXd& weights) {
    constexpr double kSigma = M_PI / 180 / kWidth;
    constexpr auto kReach = static_cast<Eigen::Index>(3 * kSigma);
    Eigen::VectorXd result = Eigen::VectorXd::Zero(kBins);
    for (Eigen::Index offset = -kReach; offset <= kReach; ++offset) {
        const auto off = static_cast<float>(static_cast<double>(offset) / kSigma);
        const double share = double{portable::exp(-0.5F * off * off)};
        for (Eigen::Index i = 0; i < kBins; ++i) result[i] += share * weights[wrapped(i + offset)];
    }
    return result;
}
}  // namespace

WallOrientations::WallOrientations(const paper::SurfaceNormals& surfaces)
    : weights_(Eigen::VectorXd::Zero(kBins)) {
    constexpr float kLevel = 0.5F;  // 30 deg
    for (Eigen::Index i = 0; i < surfaces.directions.cols(); ++i) {
        const Eigen::Vector3f n = surfaces.directions.col(i);
        if (std::abs(n.z()) > kLevel) continue;
        const double azimuth = std::atan2(n.y(), n.x());
        weights_[wrapped(static_cast<Eigen::Index>(std::floor(azimuth / kWidth)))] +=
            static_cast<double>(surfaces.planarity[i]);
    }
    weights_ = smoothed(weights_);
    // What looks every way alike says nothing.
    weights_.array() -= weights_.mean();
    if (weights_.norm() > 0) weights_.normalize();
}

std::vector<double> WallOrientations::turnsOf(const WallOrientations& other, double expected,
                                              double reach, std::size_t most) const {
    const auto at = [&](Eigen::Index turn) {
        double sum = 0;
        for (Eigen::Index i = 0; i < kBins; ++i)
            sum += weights_[wrapped(i + turn)] * other.weights_[i];
        return sum;
    };
    const auto first = static_cast<Eigen::Index>(std::floor((expected - reach) / kWidth)),
               last = static_cast<Eigen::Index>(std::ceil((expected + reach) / kWidth));
    Eigen::VectorXd scores(last - first + 1);
    for (Eigen::Index i = 0; i < scores.size(); ++i) scores[i] = at(first + i);
    std::vector<Eigen::Index> peaks;
    for (Eigen::Index i = 1; i + 1 < scores.size(); ++i)
        if (scores[i] > 0 && scores[i] >= scores[i - 1] && scores[i] > scores[i + 1])
            peaks.push_back(i);
    std::stable_sort(peaks.begin(), peaks.end(),
                     [&](Eigen::Index a, Eigen::Index b) { return scores[a] > scores[b]; });
    if (peaks.size() > most) peaks.resize(most);
    std::vector<double> turns;
    turns.reserve(peaks.size());
    for (const auto peak : peaks) turns.push_back(static_cast<double>(first + peak) * kWidth);
    return turns;
}

namespace {
constexpr double kBlock_m = 4;  // of one height of the ground
constexpr double kGround_m = 0.3;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

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

int indexOf(double metres) { return static_cast<int>(std::floor(metres / HeightImage::kCell_m)); }

using Scores = Eigen::Matrix<unsigned, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/** Number of common bits of both images, for all shifts by whole cells about (x0, y0). */
Scores correlated(const HeightImage& image, const Eigen::Matrix2Xd& cells,
                  const std::vector<std::uint8_t>& bands, const Eigen::Vector2d& expected,
                  Eigen::Index reach) {
    const Eigen::Index side = 2 * reach + 1;
    const Eigen::Matrix2Xd centres = image.cells();
    const Raster raster(centres.unaryExpr([](double metres) { return indexOf(metres); }).eval(),
                        image.bands(), static_cast<int>(side));
    Scores scores = Scores::Zero(side, side);
    tbb::parallel_for(Eigen::Index{0}, side, [&](Eigen::Index dy) {
        for (Eigen::Index i = 0; i < cells.cols(); ++i) {
            const Eigen::Vector2d centre = cells.col(i) + expected;
            const auto* row = raster.row(indexOf(centre.x()) - static_cast<int>(reach),
                                         indexOf(centre.y()) - static_cast<int>(reach - dy),
                                         static_cast<int>(side));
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

Eigen::Vector2d centreOf(const Eigen::Vector3f& point, double size) {
    return ((point.head<2>().cast<double>() / size).array().floor() + 0.5) * size;
}

/** The cells of a block in which something is above the ground. */
class BlockCells {
 public:
    void add(const Eigen::Vector3f& point, double height) {
        const auto number = index_.insert(keyAt(point.x(), point.y(), HeightImage::kCell_m));
        if (number == cells_.size()) cells_.push_back({centreOf(point, HeightImage::kCell_m), {}});
        cells_[number].heights.push_back(height);
    }

    /** Height of the level surface that covers the block, with nothing below it in most cells;
     *  infinity without one. A wall is no ceiling: its cells lie in a line. */
    double ceiling() const {
        constexpr double kRoom_m = 1.5, kFlat_m = 0.25, kBelow_m = 0.5, kBroad_m = 0.6;
        constexpr std::size_t kLeast = 8;
        std::vector<double> tops;
        for (const auto& cell : cells_) {
            const double top = *std::max_element(cell.heights.begin(), cell.heights.end());
            if (top > kRoom_m) tops.push_back(top);
        }
        const double height = median(tops);
        std::size_t isFree = 0;
        Eigen::Vector2d sum = Eigen::Vector2d::Zero();
        Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
        for (const auto& [centre, heights] : cells_) {
            const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
            if (std::abs(*high - height) > kFlat_m || *low < height - kBelow_m) continue;
            ++isFree;
            sum += centre;
            squares += centre * centre.transpose();
        }
        const auto count = static_cast<double>(isFree);
        if (isFree < kLeast || 2 * isFree < tops.size()) return kInfinity;
        const Eigen::Matrix2d scatter = (squares - sum * sum.transpose() / count) / count;
        const double narrow =
            Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(scatter, Eigen::EigenvaluesOnly)
                .eigenvalues()[0];
        return narrow > kBroad_m * kBroad_m ? height - kFlat_m : kInfinity;
    }

 private:
    struct Cell {
        Eigen::Vector2d centre;
        std::vector<double> heights;  //!< above the ground
    };
    VoxelIndex index_;
    std::vector<Cell> cells_;
};

/** Blocks of 4 m of a levelled cloud. */
class Blocks {
 public:
    explicit Blocks(const Eigen::Matrix3Xf& points);

    /** Indices of the points above the ground. */
    std::vector<Eigen::Index> aboveGround(const Eigen::Matrix3Xf& points) const;
    /** Of these, the ones that are no ceiling. */
    std::vector<Eigen::Index> standing(const Eigen::Matrix3Xf& points) const;

    std::size_t at(const Eigen::Vector3f& point) const {
        return index_.find(keyAt(point.x(), point.y(), kBlock_m));
    }
    /** Above the ground. */
    double heightOf(const Eigen::Vector3f& point) const {
        return static_cast<double>(point.z()) - grounds_[at(point)];
    }
    const std::vector<Eigen::Vector2d>& centres() const { return centres_; }
    const std::vector<double>& grounds() const { return grounds_; }

 private:
    VoxelIndex index_;
    std::vector<Eigen::Vector2d> centres_;
    std::vector<double> grounds_;  //!< metres
};

Blocks::Blocks(const Eigen::Matrix3Xf& points) {
    std::vector<std::vector<float>> heights;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const Eigen::Vector3f p = points.col(i);
        const auto number = index_.insert(keyAt(p.x(), p.y(), kBlock_m));
        if (number == heights.size()) {
            heights.emplace_back();
            centres_.push_back(centreOf(p, kBlock_m));
        }
        heights[number].push_back(p.z());
    }
    for (auto& block : heights) grounds_.push_back(lowest(block));
}

std::vector<Eigen::Index> Blocks::aboveGround(const Eigen::Matrix3Xf& points) const {
    std::vector<Eigen::Index> above;
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        if (heightOf(points.col(i)) > kGround_m) above.push_back(i);
    return above;
}

std::vector<Eigen::Index> Blocks::standing(const Eigen::Matrix3Xf& points) const {
    auto above = aboveGround(points);
    std::vector<BlockCells> cells(grounds_.size());
    for (const auto i : above) cells[at(points.col(i))].add(points.col(i), heightOf(points.col(i)));
    std::vector<double> ceilings;
    ceilings.reserve(cells.size());
    for (const auto& block : cells) ceilings.push_back(block.ceiling());
    const auto isCeiling = [&](Eigen::Index i) {
        return heightOf(points.col(i)) > ceilings[at(points.col(i))];
    };
    above.erase(std::remove_if(above.begin(), above.end(), isCeiling), above.end());
    return above;
}

Eigen::Matrix3Xd columns(const Eigen::Matrix3Xf& points, const std::vector<Eigen::Index>& which) {
    Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(which.size()));
    for (std::size_t i = 0; i < which.size(); ++i)
        result.col(static_cast<Eigen::Index>(i)) = points.col(which[i]).cast<double>();
    return result;
}

Eigen::Matrix<std::int16_t, 2, Eigen::Dynamic> halvesOf(const Eigen::Matrix2Xd& centres) {
    return (centres * 2 / HeightImage::kCell_m).array().round().cast<std::int16_t>();
}
}  // namespace

Raster::Raster(const Eigen::Matrix2Xi& cells, const std::vector<std::uint8_t>& itsBands,
               int margin) {
    if (cells.cols() == 0) return;
    const Eigen::Vector2i low = cells.rowwise().minCoeff(), high = cells.rowwise().maxCoeff();
    x0 = low.x() - margin;
    y0 = low.y() - margin;
    width = high.x() + margin + 1 - x0;
    height = high.y() + margin + 1 - y0;
    bands.assign(at(0, height), 0);
    for (Eigen::Index i = 0; i < cells.cols(); ++i) {
        auto& cell = bands[at(cells(0, i) - x0, cells(1, i) - y0)];
        cell = static_cast<std::uint8_t>(cell | itsBands[static_cast<std::size_t>(i)]);
    }
}

HeightImage::HeightImage(const Eigen::Matrix3Xf& points) {
    const Blocks blocks(points);
    heights_ = blocks.grounds();
    grounds_.resize(2, static_cast<Eigen::Index>(heights_.size()));
    for (Eigen::Index i = 0; i < grounds_.cols(); ++i) {
        grounds_.col(i) = blocks.centres()[static_cast<std::size_t>(i)];
        groundIndex_.insert(keyAt(grounds_(0, i), grounds_(1, i), kBlock_m));
    }
    std::vector<Eigen::Vector2d> centres;
    VoxelIndex cells;
    for (const auto i : blocks.standing(points)) {
        const Eigen::Vector3f p = points.col(i);
        const auto number = cells.insert(keyAt(p.x(), p.y(), kCell_m));
        if (number == bands_.size()) {
            bands_.push_back(0);
            centres.push_back(centreOf(p, kCell_m));
        }
        bands_[number] = static_cast<std::uint8_t>(bands_[number] | bandOf(blocks.heightOf(p)));
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
    return columns(points, Blocks(points).aboveGround(points));
}

Eigen::Matrix3Xd standing(const Eigen::Matrix3Xf& points) {
    return columns(points, Blocks(points).standing(points));
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

// Normals of each point from nearest neighbours found no other loops and took eight times the
// instructions.
paper::SurfaceNormals flatVoxels(const Eigen::Matrix3Xf& points) {
    PlaneMapOptions options;
    options.voxel_size = 1;
    options.levels = 1;
    options.ground_levels = 0;
    options.min_points = 5;
    options.max_flatness = 0.02;  // thickness a seventh of the breadth
    options.min_breadth = 0.1;
    odometry::PlaneMap map(options);
    map.add(points.cast<double>());
    const Eigen::Matrix3Xf firsts = firstOfVoxels(points, options.voxel_size);
    paper::SurfaceNormals walls;
    walls.directions.resize(3, firsts.cols());
    walls.planarity.resize(firsts.cols());
    Eigen::Index kept = 0;
    for (Eigen::Index i = 0; i < firsts.cols(); ++i) {
        const odometry::Plane* plane = map.at(firsts.col(i).cast<double>());
        if (!plane) continue;
        const double thickness = std::sqrt(plane->flatness());
        walls.directions.col(kept) = plane->normal().cast<float>();
        walls.planarity[kept] = static_cast<float>((1 - thickness) * plane->count);
        ++kept;
    }
    walls.directions.conservativeResize(3, kept);
    walls.planarity.conservativeResize(kept);
    return walls;
}

Descriptor::Descriptor(const Eigen::Matrix3Xf& points) : walls(flatVoxels(points)), image(points) {}
}  // namespace delio::places
