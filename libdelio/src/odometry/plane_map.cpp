#include "odometry/plane_map.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "core/principal_axes.h"
#include "core/voxel_grid.h"
#include "core/voxel_table.h"

namespace delio::odometry {
PlaneMap::PlaneMap(const PlaneMapOptions& options, const Eigen::Vector3d& up)
    : options_(options), up_(up) {
    constexpr double kLevel = 0.9;  // 26 deg: what a sensor's axis and the ground are off together
    double edge = options_.voxel_size;
    for (unsigned i = 0; i < options_.levels + options_.ground_levels; ++i, edge *= 2)
        levels_.push_back({i, edge, i < options_.levels ? 0 : kLevel, {}, {}, {}, {}});
}

void PlaneMap::Sums::add(const Eigen::Vector3d& point) {
    if (count == 0) origin = point;
    const Eigen::Vector3d d = point - origin;
    sum += d;
    squares.head<3>() += d.cwiseProduct(d);
    squares.tail<3>() += d.cwiseProduct(Eigen::Vector3d(d.y(), d.z(), d.x()));
    ++count;
}

/** Those of `other` as seen from here. */
void PlaneMap::Sums::add(const Sums& other) {
    if (count == 0) origin = other.origin;
    const Eigen::Vector3d d = other.origin - origin, end = other.sum + other.count * d;
    const auto turned = [](const Eigen::Vector3d& a) {
        return Eigen::Vector3d(a.y(), a.z(), a.x());
    };
    // (p + d) (p + d)^T over all p.
    squares += other.squares;
    squares.head<3>() += d.cwiseProduct(other.sum + end);
    squares.tail<3>() += d.cwiseProduct(turned(other.sum)) + end.cwiseProduct(turned(d));
    sum += end;
    count += other.count;
}

/** Its origin stays: what is far is forgotten by it. */
void PlaneMap::Sums::clear() {
    sum.setZero();
    squares.setZero();
    count = 0;
}

Eigen::Matrix3d PlaneMap::Sums::scatter() const {
    Eigen::Matrix3d all;
    all << squares[0], squares[3], squares[5],  //
        squares[3], squares[1], squares[4],     //
        squares[5], squares[4], squares[2];
    return all;
}

void PlaneMap::Level::clear() {
    cells.clear();
    forgetPlanes();
}

void PlaneMap::Level::forgetPlanes() {
    states.assign(cells.size(), State::Unknown);
    planes.resize(cells.size());
    latest.clear();
}

PlaneMap::State PlaneMap::fit(const Level& level, std::uint32_t number) const {
    const Sums& cell = level.cells[number];
    if (cell.count < options_.min_points) return State::None;
    const double share = 1.0 / cell.count, least = options_.min_breadth * level.edge,
                 most = options_.max_thickness * options_.max_thickness;
    const Eigen::Vector3d mean = share * cell.sum;
    const Eigen::Matrix3d scatter = share * cell.scatter() - mean * mean.transpose();
    // Most cells have no plane, and most of these are ruled out before their axes are known. The
    // smallest variance is no less than the determinant over the minors; the middle one no more
    // than the minors over the largest, and that no less than any on the diagonal.
    const CharacteristicPolynomial roots(scatter);
    const bool isRound = roots.determinant() * scatter.diagonal().maxCoeff() >
                         options_.max_flatness * roots.minors() * roots.minors();
    if (isRound || roots.above(least * least) < 2 || roots.above(most) == 3) return State::None;
    const auto pca = principalAxes(scatter);
    // Never thinner than rounding allows.
    const Eigen::Vector3d variances = pca.variances.cwiseMax(1e-9);
    const bool isPlane =
        variances[0] < most && variances[0] < options_.max_flatness * variances[1] &&
        variances[1] > least * least && std::abs(pca.axes.col(0).dot(up_)) >= level.steepest;
    if (!isPlane) return State::None;
    const Eigen::Vector2d tilts = share * variances[0] * variances.tail<2>().cwiseInverse();
    level.planes[number] = {cell.origin + mean, pca.axes, variances[0],
                            static_cast<double>(cell.count), tilts};
    return State::Plane;
}

/** Fitted by the first thread that asks; others wait. */
const Plane* PlaneMap::planeIn(const Level& level, std::uint32_t number) const {
    SharedState& state = level.states[number];
    State now = state.load(std::memory_order_acquire);
    if (now == State::Unknown && state.compare_exchange_strong(now, State::BeingFitted)) {
        now = fit(level, number);
        state.store(now, std::memory_order_release);
    }
    while (now == State::BeingFitted) {
        std::this_thread::yield();
        now = state.load(std::memory_order_acquire);
    }
    return now == State::Plane ? &level.planes[number] : nullptr;
}

/** A scan's points in each of the smallest voxels, in the order in which these are first met. */
PlaneMap::Batch PlaneMap::batchOf(const Eigen::Matrix3Xd& points) const {
    constexpr Eigen::Index kTypical = 2;  // points a voxel
    const auto typical = static_cast<std::size_t>(points.cols() / kTypical);
    VoxelIndex numbers;
    numbers.reserve(typical);
    Batch batch;
    batch.voxels.reserve(typical);
    batch.sums.reserve(typical);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const std::uint64_t voxel = voxelAt(points.col(i));
        const std::uint32_t number = numbers.insert(voxel);
        if (number == batch.sums.size()) {
            batch.voxels.push_back(voxel);
            batch.sums.emplace_back();
        }
        batch.sums[number].add(points.col(i));
    }
    return batch;
}

void PlaneMap::add(const Batch& batch, Level& level) const {
    std::vector<std::uint64_t> voxels(batch.voxels.size());
    std::transform(batch.voxels.begin(), batch.voxels.end(), voxels.begin(),
                   [&](std::uint64_t voxel) { return coarserKey(voxel, level.number); });
    auto numbers = level.cells.insert(voxels);
    level.states.resize(level.cells.size());
    level.planes.resize(level.cells.size());
    level.cells.forEach(numbers, [&](std::size_t i, Sums& cell) {
        if (cell.count >= options_.max_points) return;
        cell.add(batch.sums[i]);
        level.states[numbers[i]].store(State::Unknown, std::memory_order_relaxed);
    });
    level.latest = std::move(numbers);
}

void PlaneMap::add(const Eigen::Matrix3Xd& points) {
    const Batch batch = batchOf(points);
    tbb::parallel_for(std::size_t{0}, levels_.size(),
                      [&](std::size_t i) { add(batch, levels_[i]); });
}

void PlaneMap::fitLatest() const {
    constexpr std::size_t kTogether = 256;
    for (std::size_t i = 0; i < finest(); ++i) {
        const Level& level = levels_[i];
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, level.latest.size(), kTogether),
                          [&](const tbb::blocked_range<std::size_t>& range) {
                              for (std::size_t k = range.begin(); k != range.end(); ++k)
                                  planeIn(level, level.latest[k]);
                          });
    }
}

void PlaneMap::erase(const Eigen::Matrix3Xd& points) {
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
        const std::uint64_t voxel = voxelAt(points.col(k));
        for (std::size_t i = 0; i < options_.levels; ++i) {
            Level& level = levels_[i];
            const std::uint32_t cell = level.cells.numberOf(coarserKey(voxel, level.number));
            if (cell == VoxelIndex::kNone) continue;
            level.cells[cell].clear();
            level.states[cell] = State::None;
        }
    }
}

void PlaneMap::forgetFarFrom(const Eigen::Vector3d& centre) {
    tbb::parallel_for(std::size_t{0}, levels_.size(), [&](std::size_t i) {
        Level& level = levels_[i];
        const VoxelBall near(centre, options_.radius, levels_.front().edge, level.number);
        const auto isFar = [&](std::uint64_t voxel, const Sums& cell) {
            return !near.holds(voxel) && (cell.origin - centre).norm() > options_.radius;
        };
        level.cells.eraseIf(isFar, [&](std::uint32_t from, std::uint32_t to) {
            level.states[to] = level.states[from];
            if (level.states[to] == State::Plane) level.planes[to] = level.planes[from];
        });
        level.states.resize(level.cells.size());
        level.planes.resize(level.cells.size());
        level.latest.clear();  // numbers have changed
    });
}

void PlaneMap::clear(const Eigen::Vector3d& up) {
    up_ = up;
    for (auto& level : levels_) level.clear();
}

std::size_t PlaneMap::voxels() const {
    std::size_t count = 0;
    for (const auto& level : levels_) count += level.cells.size();
    return count;
}

std::size_t PlaneMap::planes() const {
    std::size_t count = 0;
    for (const auto& level : levels_)
        for (std::uint32_t i = 0; i < level.cells.size(); ++i)
            count += planeIn(level, i) != nullptr;
    return count;
}

std::uint64_t PlaneMap::voxelAt(const Eigen::Vector3d& point) const {
    return voxelKey(point, levels_.front().edge);
}

void PlaneMap::prefetch(std::uint64_t voxel) const {
    for (std::size_t i = 0; i < finest(); ++i)
        levels_[i].cells.prefetch(coarserKey(voxel, levels_[i].number));
}

PlaneMap::Cells PlaneMap::cellsAbout(std::uint64_t voxel) const {
    Cells cells{VoxelIndex::kNone, VoxelIndex::kNone};
    for (std::size_t i = 0; i < finest(); ++i) {
        cells[i] = levels_[i].cells.numberOf(coarserKey(voxel, levels_[i].number));
        if (cells[i] != VoxelIndex::kNone) __builtin_prefetch(&levels_[i].states[cells[i]]);
    }
    return cells;
}

void PlaneMap::prefetchPlane(const Cells& cells) const {
    for (std::size_t i = 0; i < finest(); ++i) {
        if (cells[i] == VoxelIndex::kNone) continue;
        const Level& level = levels_[i];
        const State state = level.states[cells[i]].load(std::memory_order_relaxed);
        if (state == State::None) continue;
        __builtin_prefetch(&level.planes[cells[i]]);
        __builtin_prefetch(&level.planes[cells[i]].tilts);
        if (state == State::Plane) return;
        level.cells.prefetchValue(cells[i]);  // which it is fitted from
    }
}

const Plane* PlaneMap::planeIn(std::uint64_t voxel, const Cells& cells) const {
    for (std::size_t i = 0; i < levels_.size(); ++i) {
        const Level& level = levels_[i];
        const std::uint32_t cell =
            i < finest() ? cells[i] : level.cells.numberOf(coarserKey(voxel, level.number));
        if (cell == VoxelIndex::kNone) continue;
        if (const Plane* plane = planeIn(level, cell)) return plane;
    }
    return nullptr;
}
}  // namespace delio::odometry
