#include "delio/planes/plane_map.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "delio/scan/voxel_grid.h"

namespace delio::planes {
std::vector<OptionField> PlaneMapOptions::fields() const {
    return {{"voxel_size", &PlaneMapOptions::voxel_size,
             "m; edge of the smallest voxels that hold a plane each", 0.05, 20},
            {"levels", &PlaneMapOptions::levels,
             "of voxels, each twice as large: where the smaller one holds no plane, the larger may",
             1, 6},
            {"ground_levels", &PlaneMapOptions::ground_levels,
             "more of them, again twice as large each, whose planes have to be level", 0, 6},
            {"min_points", &PlaneMapOptions::min_points, "points that a plane needs", 3, 1e6},
            {"max_thickness", &PlaneMapOptions::max_thickness,
             "m; standard deviation of a plane's points across it", 1e-4, 10},
            {"max_flatness", &PlaneMapOptions::max_flatness,
             "largest share of the smallest variance in the middle one; more is no plane", 0, 1},
            {"min_breadth", &PlaneMapOptions::min_breadth,
             "voxel edges; standard deviation of a plane's points along its shorter side: rows of "
             "one ring are no plane, whose normal is known (a voxel's full side has 0.29)",
             0, 0.28},
            {"max_points", &PlaneMapOptions::max_points, "points after which a voxel takes no more",
             3, 1e9},
            {"radius", &PlaneMapOptions::radius, "m; the map ends at this distance from the sensor",
             1, 1e4}};
}

PlaneMap::PlaneMap(const PlaneMapOptions& options, const Eigen::Vector3d& up)
    : options_(options), up_(up) {
    constexpr double kLevel = 0.9;  // 26 deg: what a sensor's axis and the ground are off together
    double edge = options_.voxel_size;
    for (unsigned i = 0; i < options_.levels + options_.ground_levels; ++i, edge *= 2)
        levels_.push_back({edge, i < options_.levels ? 0 : kLevel, {}});
}

double Plane::varianceAt(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d d = axes.transpose() * (point - mean);
    return variances[0] *
           (1 + (1 + d[1] * d[1] / variances[1] + d[2] * d[2] / variances[2]) / count);
}

void PlaneMap::fit(const Level& level, Cell& cell) const {
    cell.touched = false;
    if (cell.count < options_.min_points) return;
    const Eigen::Vector3d mean = cell.sum / cell.count;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> pca;
    pca.computeDirect(cell.squares / cell.count - mean * mean.transpose());
    // Never thinner than rounding allows.
    const Eigen::Vector3d variances = pca.eigenvalues().cwiseMax(1e-9);
    const double least = options_.min_breadth * level.edge;
    cell.isPlane = std::sqrt(variances[0]) < options_.max_thickness &&
                   variances[0] < options_.max_flatness * variances[1] &&
                   variances[1] > least * least &&
                   std::abs(pca.eigenvectors().col(0).dot(up_)) >= level.steepest;
    cell.plane = {cell.origin + mean, variances, pca.eigenvectors(),
                  static_cast<double>(cell.count)};
}

/** Once more, as when the last points came. */
void PlaneMap::fitAll() {
    for (auto& level : levels_)
        tbb::parallel_for(std::size_t{0}, level.cells.size(), [&](std::size_t i) {
            fit(level, level.cells[static_cast<std::uint32_t>(i)]);
        });
}

void PlaneMap::add(const Eigen::Matrix3Xd& points, Level& level) const {
    std::vector<std::uint32_t> touched;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const Eigen::Vector3d point = points.col(i);
        const std::uint32_t number = level.cells.insert(scan::voxelKey(point, level.edge));
        Cell& cell = level.cells[number];
        if (cell.count == 0) cell.origin = point;
        if (cell.count >= options_.max_points) continue;
        const Eigen::Vector3d d = point - cell.origin;
        cell.sum += d;
        cell.squares += d * d.transpose();
        ++cell.count;
        if (!cell.touched) touched.push_back(number);
        cell.touched = true;
    }
    tbb::parallel_for(std::size_t{0}, touched.size(),
                      [&](std::size_t i) { fit(level, level.cells[touched[i]]); });
}

void PlaneMap::add(const Eigen::Matrix3Xd& points) {
    tbb::parallel_for(std::size_t{0}, levels_.size(),
                      [&](std::size_t i) { add(points, levels_[i]); });
}

void PlaneMap::erase(const Eigen::Matrix3Xd& points) {
    for (std::size_t i = 0; i < options_.levels; ++i)
        for (Eigen::Index k = 0; k < points.cols(); ++k) {
            Cell* cell = levels_[i].cells.find(
                scan::voxelKey(Eigen::Vector3d(points.col(k)), levels_[i].edge));
            if (!cell) continue;
            cell->sum.setZero();
            cell->squares.setZero();
            cell->count = 0;  // its origin stays: what is far is forgotten by it
            cell->isPlane = false;
        }
}

void PlaneMap::forgetFarFrom(const Eigen::Vector3d& centre) {
    for (auto& level : levels_)
        level.cells.eraseIf(
            [&](const Cell& cell) { return (cell.origin - centre).norm() > options_.radius; });
}

void PlaneMap::clear(const Eigen::Vector3d& up) {
    up_ = up;
    for (auto& level : levels_) level.cells.clear();
}

std::size_t PlaneMap::voxels() const {
    std::size_t count = 0;
    for (const auto& level : levels_) count += level.cells.size();
    return count;
}

std::size_t PlaneMap::planes() const {
    std::ptrdiff_t count = 0;
    for (const auto& level : levels_)
        count += std::count_if(level.cells.begin(), level.cells.end(),
                               [](const Cell& cell) { return cell.isPlane; });
    return static_cast<std::size_t>(count);
}

const Plane* PlaneMap::at(const Eigen::Vector3d& point) const {
    for (const auto& level : levels_) {
        const Cell* cell = level.cells.find(scan::voxelKey(point, level.edge));
        if (cell && cell->isPlane) return &cell->plane;
    }
    return nullptr;
}
}  // namespace delio::planes
