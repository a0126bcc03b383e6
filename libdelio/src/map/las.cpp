#include "delio/map/cloud_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "formats/las.h"
#include "map/ground.h"

namespace delio::map {
namespace {
constexpr double kGround_m = 0.2;  // to either side of the ground
constexpr std::uint8_t kOther = 1, kGround = 2;

/** A value of a point that LAS has no place for. */
struct Extra {
    const char *name, *description;
    io::NumberKind kind;
    double (*get)(const MapPoint&);
    void (*set)(MapPoint&, double);
};

std::uint16_t countOf(double value) {
    constexpr double kMost = std::numeric_limits<std::uint16_t>::max();
    return static_cast<std::uint16_t>(std::clamp(value, 0.0, kMost));
}

const std::array<Extra, 5> kExtras{{
    {"observations", "scans that hit the voxel", io::NumberKind::kUint16,
     [](const MapPoint& p) { return static_cast<double>(p.observations); },
     [](MapPoint& p, double v) { p.observations = countOf(v); }},
    {"residual", "distance from the plane, m", io::NumberKind::kFloat32,
     [](const MapPoint& p) { return double{p.residual_m}; },
     [](MapPoint& p, double v) { p.residual_m = static_cast<float>(v); }},
    {"normalx", "surface normal", io::NumberKind::kFloat32,
     [](const MapPoint& p) { return double{p.normal.x()}; },
     [](MapPoint& p, double v) { p.normal.x() = static_cast<float>(v); }},
    {"normaly", "surface normal", io::NumberKind::kFloat32,
     [](const MapPoint& p) { return double{p.normal.y()}; },
     [](MapPoint& p, double v) { p.normal.y() = static_cast<float>(v); }},
    {"normalz", "surface normal", io::NumberKind::kFloat32,
     [](const MapPoint& p) { return double{p.normal.z()}; },
     [](MapPoint& p, double v) { p.normal.z() = static_cast<float>(v); }},
}};

/** What makes full use of 16 bits. */
float intensityScale(const MapPoints& points) {
    float highest = 0;
    for (const auto& point : points) highest = std::max(highest, point.intensity);
    return highest <= 1 ? 65535.0F : highest <= 255 ? 256.0F : 1.0F;
}

/** The ground below the map, with cells as coarse as its extent asks for. */
GroundSurface groundBelow(const MapPoints& points) {
    constexpr double kCell_m = 1, kMostCells = 1e8;
    Eigen::AlignedBox2d extent;
    for (const auto& point : points)
        extent.extend(Eigen::Vector2d(point.position.head<2>().cast<double>()));
    const double area = points.empty() ? 0 : extent.sizes().prod();
    return {points, std::max(kCell_m, std::sqrt(area / kMostCells))};
}

bool isGround(const GroundSurface& ground, const MapPoint& point) {
    const double x = point.position.x(), y = point.position.y();
    return ground.isGround(x, y) &&
           std::abs(double{point.position.z()} - ground.at(x, y)) <= kGround_m;
}
}  // namespace

void saveLas(const MapPoints& points, const std::string& path, const LasPlace& place) {
    io::LasFile file;
    file.wkt = place.wkt;
    file.gpsTime = place.firstScan_unix_s.has_value();
    for (const auto& extra : kExtras)
        file.extras.push_back({extra.name, extra.kind, extra.description});
    const double start_s = file.gpsTime ? io::gpsTimeOf(*place.firstScan_unix_s) : 0;
    const float scale = intensityScale(points);
    const GroundSurface ground = groundBelow(points);
    io::saveLas(
        file, points.size(),
        [&](std::size_t i, io::LasPoint& to) {
            const MapPoint& point = points[i];
            to.position = point.position.cast<double>();
            if (place.coordinatesOf) to.position = place.coordinatesOf(to.position);
            to.intensity = countOf(std::round(double{point.intensity} * double{scale}));
            to.classification = isGround(ground, point) ? kGround : kOther;
            to.time_s = start_s + double{point.time_s};
            for (std::size_t k = 0; k < kExtras.size(); ++k) to.extras[k] = kExtras[k].get(point);
        },
        path);
}

LasMap loadLas(const std::string& path) {
    constexpr double kNear_m = 20000, kStep_m = 1000;  // floats are good to 1 mm up to here
    io::LasReader las(path);
    const auto& header = las.header();
    std::array<const io::PointField*, kExtras.size()> found{};
    for (std::size_t k = 0; k < kExtras.size(); ++k)
        for (const auto& extra : header.extras)
            if (extra.name == kExtras[k].name) found[k] = &extra;
    LasMap map;
    map.wkt = header.wkt;
    map.points.reserve(header.count);
    std::optional<double> first_s;
    std::vector<double> times_s;
    las.forEach([&](const std::uint8_t* record) {
        const Eigen::Vector3d position = las.position(record);
        if (map.points.empty() && position.cwiseAbs().maxCoeff() > kNear_m)
            map.offset << (position.head<2>() / kStep_m).array().round() * kStep_m, 0;
        MapPoint point;
        point.position = (position - map.offset).cast<float>();
        point.intensity = static_cast<float>(io::numberAt(record + 12, io::NumberKind::kUint16));
        for (std::size_t k = 0; k < kExtras.size(); ++k) {
            if (!found[k]) continue;
            const double value = io::numberAt(record + found[k]->offset, found[k]->kind);
            if (std::isfinite(value)) kExtras[k].set(point, value);
        }
        if (header.timeAt) {
            const double time_s = io::numberAt(record + *header.timeAt, io::NumberKind::kFloat64);
            times_s.push_back(std::isfinite(time_s) ? time_s : 0);
            first_s = std::min(first_s.value_or(times_s.back()), times_s.back());
        }
        map.points.push_back(point);
    });
    for (std::size_t i = 0; i < times_s.size(); ++i)
        map.points[i].time_s = static_cast<float>(times_s[i] - *first_s);
    return map;
}
}  // namespace delio::map
