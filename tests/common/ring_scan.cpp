#include "ring_scan.h"

#include <mrpt/maps/CSimplePointsMap.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

namespace delio::test {
namespace {
/** Where the ray first meets the block's surface; infinite if nowhere. */
double distanceTo(const Block& block, const Eigen::Vector3d& from, const Eigen::Vector3d& ray) {
    const Eigen::Array3d a = (block.low - from).array() / ray.array();
    const Eigen::Array3d b = (block.high - from).array() / ray.array();
    const double enters = a.min(b).maxCoeff(), leaves = a.max(b).minCoeff();
    if (leaves < enters || leaves <= 0) return std::numeric_limits<double>::infinity();
    return enters > 0 ? enters : leaves;
}
double elevationOf(const Sensor& sensor, unsigned ring) {
    if (!sensor.elevations_deg.empty()) return sensor.elevations_deg[ring] * M_PI / 180;
    const double step = (sensor.highest_deg - sensor.lowest_deg) / (sensor.rings - 1);
    return (sensor.highest_deg - ring * step) * M_PI / 180;
}
}  // namespace

double Noise::normal() {
    double sum = 0;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum / 2;  // twelve variances of 1/3
}

Eigen::Vector3d Noise::normals() {
    const double x = normal(), y = normal(), z = normal();
    return {x, y, z};
}

Eigen::Vector3d Noise::direction() {
    const double z = uniform(), azimuth = M_PI * uniform(), flat = std::sqrt(1 - z * z);
    return {flat * std::cos(azimuth), flat * std::sin(azimuth), z};
}

Eigen::Matrix3d rotationAbout(const Eigen::Vector3d& axis, double degrees) {
    return Eigen::AngleAxisd(degrees * M_PI / 180, axis.normalized()).toRotationMatrix();
}

Scene yard() {
    return {{{-60, -60, -3}, {60, 60, -1.8}}, {{-30, -24, -5}, {37, 19, 12}},
            {{8, 7, -2}, {13, 12, 1.5}},      {{-9, 9, -2}, {-4, 17, 5}},
            {{17, -14, -2}, {22, -8, 4}},     {{-3, -13, -2}, {6, -9, 0.5}},
            {{24, 6, -2}, {26, 9, 3}},        {{-17, -8, -2}, {-13, 2, 2}},
            {{-20, -20, -2}, {-12, -14, 6}},  {{27, -4, -2}, {29, 0, 6}},
            {{1.5, 14, -2}, {3, 15.5, 5}},    {{9, -19, -2}, {10.5, -17.5, 5}}};
}

Scene room() {
    return {{{-9, -7, -1.8}, {12, 8, 3}},
            {{5, 4, -2}, {7, 6, 1}},
            {{-6, -5, -2}, {-4, -3, 2}},
            {{7, -6, -2}, {8, -4, 4}}};
}

Scene highway(bool bushes) {
    Scene scene{{{-500, -300, -2.8}, {500, 300, -1.8}},
                {{-500, 8, -1.8}, {500, 8.3, -1}},
                {{-500, -8.3, -1.8}, {500, -8, -1}}};
    Noise noise(5);
    for (int i = 0; bushes && i < 300; ++i) {
        const double x = 80 * noise.uniform(), y = 18 + 8 * noise.uniform(), side = i % 2 ? 1 : -1,
                     height = 2 + 1.5 * noise.uniform();
        scene.push_back({{x, side * y - 0.4, -1.8}, {x + 0.8, side * y + 0.4, height}});
    }
    return scene;
}

Scene corridor() {
    return {{{-1e4, -9, -3}, {1e4, 9, -1.8}},
            {{-1e4, -7, -2}, {1e4, -6, 30}},
            {{-1e4, 5, -2}, {1e4, 6, 30}}};
}

RingScan ringScan(const Scene& scene, const Eigen::Isometry3d& pose, const Sensor& sensor,
                  Noise& noise) {
    const Eigen::Matrix3d R = pose.linear();
    const Eigen::Vector3d at = pose.translation();
    RingScan scan;
    scan.points.resize(3, static_cast<Eigen::Index>(sensor.rings) * sensor.columns);
    Eigen::Index count = 0;
    for (unsigned ring = 0; ring < sensor.rings; ++ring)
        for (unsigned column = 0; column < sensor.columns; ++column) {
            const double elevation = elevationOf(sensor, ring);
            // Half a step on, so that noise does not carry a point over the seam.
            const double azimuth = (column + 0.5) * 2 * M_PI / sensor.columns;
            const Eigen::Vector3d ray(std::cos(elevation) * std::cos(azimuth),
                                      std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
            double range = std::numeric_limits<double>::infinity();
            for (const auto& block : scene) range = std::min(range, distanceTo(block, at, R * ray));
            if (!std::isfinite(range)) continue;
            range += sensor.noise_m * noise.normal();
            scan.points.col(count++) = (range * ray).cast<float>();
            scan.rings.push_back(static_cast<std::uint16_t>(ring));
        }
    scan.points.conservativeResize(3, count);
    return scan;
}

Scan scanOf(const Eigen::Matrix3Xf& points) {
    Scan scan;
    scan.points = mrpt::maps::CSimplePointsMap::Create();
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        scan.points->insertPointFast(points(0, i), points(1, i), points(2, i));
    return scan;
}
}  // namespace delio::test
