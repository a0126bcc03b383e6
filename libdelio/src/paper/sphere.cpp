#include "paper/sphere.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/portable_math.h"

namespace delio::paper {
Eigen::Vector3d sphereLog(const Eigen::Vector3d& at, const Eigen::Vector3d& n) {
    const Eigen::Vector3d across = n - at.dot(n) * at;
    const double sine = across.norm();
    const double angle = portable::atan2(sine, at.dot(n));
    if (sine > 0) return angle / sine * across;
    return angle * at.unitOrthogonal();
}

Eigen::Vector3d sphereExp(const Eigen::Vector3d& at, const Eigen::Vector3d& tangent) {
    const double angle = tangent.norm();
    if (angle == 0) return at;
    return (portable::cos(angle) * at + portable::sin(angle) / angle * tangent).normalized();
}

Eigen::Matrix3Xd sphereGrid(double spacing_deg) {
    const double spacing = spacing_deg * M_PI / 180;
    const int rows = std::max(1, static_cast<int>(std::lround(M_PI / spacing)));
    std::vector<Eigen::Vector3d> grid;
    for (int row = 0; row < rows; ++row) {
        const double elevation = M_PI * ((row + 0.5) / rows - 0.5);
        const double round = 2 * M_PI * portable::cos(elevation);
        const int steps = std::max(3, static_cast<int>(std::lround(round / spacing)));
        for (int step = 0; step < steps; ++step) {
            const double azimuth = 2 * M_PI * step / steps;
            grid.emplace_back(portable::cos(elevation) * portable::cos(azimuth),
                              portable::cos(elevation) * portable::sin(azimuth),
                              portable::sin(elevation));
        }
    }
    return Eigen::Map<const Eigen::Matrix3Xd>(grid.front().data(), 3,
                                              static_cast<Eigen::Index>(grid.size()));
}
}  // namespace delio::paper
