#include "delio/planes/plane_map.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "delio/scan/voxel_grid.h"

namespace delio::planes {
std::vector<OptionField> PlaneMapOptions::fields() const {
    return {{"voxel_size", &PlaneMapOptions::voxel_size,
             "m; edge of the voxels that hold a plane each", 0.05, 20},
            {"min_points", &PlaneMapOptions::min_points, "points that a plane needs", 3, 1e6},
            {"max_thickness", &PlaneMapOptions::max_thickness,
             "m; standard deviation of a plane's points across it", 1e-4, 10},
            {"max_flatness", &PlaneMapOptions::max_flatness,
             "largest share of the smallest variance in the middle one; more is no plane", 0, 1},
            {"max_points", &PlaneMapOptions::max_points, "points after which a voxel takes no more",
             3, 1e9},
            {"radius", &PlaneMapOptions::radius, "m; the map ends at this distance from the sensor",
             1, 1e4}};
}

double Plane::varianceAt(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d d = axes.transpose() * (point - mean);
    return variances[0] *
           (1 + (1 + d[1] * d[1] / variances[1] + d[2] * d[2] / variances[2]) / count);
}

void PlaneMap::fit(Cell& cell) const {
    cell.touched = false;
    if (cell.count < options_.min_points) return;
    const Eigen::Vector3d mean = cell.sum / cell.count;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> pca;
    pca.computeDirect(cell.squares / cell.count - mean * mean.transpose());
    // Never thinner than rounding allows.
    const Eigen::Vector3d variances = pca.eigenvalues().cwiseMax(1e-9);
    // Two rows of points of one ring are a plane; a single row is a line.
    constexpr double kBreadth = 0.01;
    cell.isPlane = std::sqrt(variances[0]) < options_.max_thickness &&
                   variances[0] < options_.max_flatness * variances[1] &&
                   variances[1] > kBreadth * variances[2];
    cell.plane = {cell.origin + mean, variances, pca.eigenvectors(),
                  static_cast<double>(cell.count)};
}

void PlaneMap::add(const Eigen::Matrix3Xd& points) {
    std::vector<Cell*> touched;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const Eigen::Vector3d point = points.col(i);
        Cell& cell = cells_[scan::voxelKey(point, options_.voxel_size)];
        if (cell.count == 0) cell.origin = point;
        if (cell.count >= options_.max_points) continue;
        const Eigen::Vector3d d = point - cell.origin;
        cell.sum += d;
        cell.squares += d * d.transpose();
        ++cell.count;
        if (!cell.touched) touched.push_back(&cell);
        cell.touched = true;
    }
    tbb::parallel_for(std::size_t{0}, touched.size(), [&](std::size_t i) { fit(*touched[i]); });
}

void PlaneMap::forgetFarFrom(const Eigen::Vector3d& centre) {
    for (auto i = cells_.begin(); i != cells_.end();)
        i = (i->second.origin - centre).norm() > options_.radius ? cells_.erase(i) : std::next(i);
}

std::size_t PlaneMap::planes() const {
    return static_cast<std::size_t>(std::count_if(
        cells_.begin(), cells_.end(), [](const auto& entry) { return entry.second.isPlane; }));
}

const Plane* PlaneMap::at(const Eigen::Vector3d& point) const {
    const auto cell = cells_.find(scan::voxelKey(point, options_.voxel_size));
    return cell == cells_.end() || !cell->second.isPlane ? nullptr : &cell->second.plane;
}
}  // namespace delio::planes
