#include "delio/planes/plane_search.h"

#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "delio/scan/sample.h"

namespace delio::planes {
double agreement(const PlaneMap& map, const surfaces::SurfaceNormals& surfaces,
                 const Eigen::Isometry3d& pose, double kernel) {
    const Eigen::Matrix3d R = pose.linear();
    const Eigen::Vector3d t = pose.translation();
    constexpr double kSameWay = 0.95;  // cosine
    Eigen::Matrix3d all = Eigen::Matrix3d::Zero(), found = all;
    for (Eigen::Index i = 0; i < surfaces.points.cols(); ++i) {
        const Eigen::Vector3d normal = R * surfaces.directions.col(i).cast<double>();
        all += normal * normal.transpose();
        const Eigen::Vector3d placed = R * surfaces.points.col(i).cast<double>() + t;
        const Plane* plane = map.at(placed);
        if (!plane || std::abs(plane->normal().dot(normal)) < kSameWay) continue;
        const double r = plane->normal().dot(placed - plane->mean) / kernel;
        found += normal * normal.transpose() / (1 + r * r);
    }
    // The trace of all^-1 found: each direction's share of what could be found there.
    return all.completeOrthogonalDecomposition().solve(found).trace() / 3;
}

PlaneEstimate searchInPlanes(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                             const surfaces::SurfaceNormals& surfaces,
                             const Eigen::Isometry3d& centre, double radius,
                             const PlaneRegistrationOptions& options) {
    const Eigen::Matrix3d R = centre.linear();
    constexpr std::size_t kBest = 12;
    // A part tells which starts are good, and where they lead to.
    constexpr Eigen::Index kEnough = 1000;
    const Eigen::Matrix3Xd part = scan::sample(points, kEnough);
    surfaces::SurfaceNormals few;
    few.points = scan::sample(surfaces.points, kEnough);
    few.directions = scan::sample(surfaces.directions, kEnough);
    const int steps = static_cast<int>(radius / options.search_step);
    std::vector<std::pair<double, Eigen::Vector3d>> starts;
    for (int x = -steps; x <= steps; ++x)
        for (int y = -steps; y <= steps; ++y) {
            const Eigen::Vector3d offset(x * options.search_step, y * options.search_step, 0);
            if (offset.norm() <= radius) starts.emplace_back(0, centre.translation() + offset);
        }
    tbb::parallel_for(std::size_t{0}, starts.size(), [&](std::size_t i) {
        starts[i].first =
            agreement(map, few, isometry(R, starts[i].second), options.search_step / 2);
    });
    std::stable_sort(starts.begin(), starts.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    if (starts.size() > kBest) starts.resize(kBest);
    starts.emplace_back(0, centre.translation());
    PlaneEstimate best;
    double bestAgreement = -1;
    for (const auto& [rough, t] : starts) {
        const auto found = registerToPlanes(map, part, priorOf(isometry(R, t), options),
                                            options.search_step, options);
        const double agreed = agreement(map, surfaces, found.pose(), 2 * options.last_kernel);
        if (agreed <= bestAgreement) continue;
        best = found;
        bestAgreement = agreed;
    }
    return best;
}
}  // namespace delio::planes
