#include "toy_drive.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>
#include <sstream>

#include "delio/formats/trajectory.h"
#include "poses.h"
#include "test_data.h"

namespace delio::test {
namespace fs = std::filesystem;

namespace {
/** Turned about the z axis, so that there are walls of many directions. */
struct Box {
    std::array<double, 3> low, high;  //!< in its own axes
    double x, y, yaw;
};

std::vector<Box> street() {
    std::vector<Box> boxes;
    std::mt19937 random(5);
    const auto draw = [&](double from, double to) {
        return from + (to - from) * static_cast<double>(random()) / 4294967296.0;
    };
    for (double x = -60; x < 100; x += 9)
        for (const double side : {-1.0, 1.0}) {
            const double halfLength = draw(2, 4), halfDepth = draw(2, 4);
            boxes.push_back({{-halfLength, -halfDepth, -1.7},
                             {halfLength, halfDepth, draw(2, 9)},
                             x + draw(0, 3),
                             side * draw(10, 14),
                             draw(-0.8, 0.8)});
            boxes.push_back({{-0.2, -0.2, -1.7},
                             {0.2, 0.2, draw(0, 4)},
                             x + draw(0, 9),
                             side * draw(3.5, 5),
                             draw(-0.8, 0.8)});
        }
    return boxes;
}

/** Distance along the ray to the ground or to a box. */
double rangeOf(const std::vector<Box>& boxes, const Eigen::Vector3d& at,
               const std::array<double, 3>& ray) {
    double nearest = ray[2] < 0 ? (-1.7 - at.z()) / ray[2] : 1e9;
    for (const auto& box : boxes) {
        const double c = std::cos(box.yaw), sn = std::sin(box.yaw);
        const double dx = at.x() - box.x, dy = at.y() - box.y;
        const std::array<double, 3> from = {c * dx + sn * dy, c * dy - sn * dx, at.z()};
        const std::array<double, 3> along = {c * ray[0] + sn * ray[1], c * ray[1] - sn * ray[0],
                                             ray[2]};
        double in = 0, out = 1e9;
        for (std::size_t k = 0; k < 3; ++k) {
            const double a = (box.low[k] - from[k]) / along[k];
            const double b = (box.high[k] - from[k]) / along[k];
            in = std::max(in, std::min(a, b));
            out = std::min(out, std::max(a, b));
        }
        if (in < out && in > 0) nearest = std::min(nearest, in);
    }
    return nearest;
}
}  // namespace

Floats toyScan(const Eigen::Vector3d& position) {
    const auto boxes = street();
    std::mt19937 random(static_cast<unsigned>(std::lround(1000 * position.x())));
    Floats points;
    for (int ring = 0; ring < 64; ++ring)
        for (int i = 0; i < 600; ++i) {
            const double elevation = (2.0 - 26.8 * ring / 63) * M_PI / 180;
            const double azimuth = (i + 0.5) * M_PI / 300;
            const std::array<double, 3> ray = {std::cos(elevation) * std::cos(azimuth),
                                               std::cos(elevation) * std::sin(azimuth),
                                               std::sin(elevation)};
            const double noise = 0.06 * (static_cast<double>(random()) / 4294967296.0 - 0.5);
            const double range = rangeOf(boxes, position, ray) + noise;
            if (range > 70) continue;
            for (const double axis : ray) points.push_back(static_cast<float>(axis * range));
            points.push_back(static_cast<float>(ring) / 64.0F);
        }
    return points;
}

std::vector<Floats> toyScans(std::size_t count, double step_m) {
    std::vector<Floats> scans;
    for (std::size_t i = 0; i < count; ++i)
        scans.push_back(toyScan({step_m * static_cast<double>(i), 0, 0}));
    return scans;
}

void writeSequence(const fs::path& folder, const std::vector<Floats>& scans, double step_m) {
    fs::create_directories(folder / "velodyne");
    io::Trajectory cam0;
    std::string times;
    for (std::size_t i = 0; i < scans.size(); ++i) {
        writeFloats(folder / "velodyne" / scanName(i), scans[i]);
        cam0.poses.push_back(poseAt(0, 0, step_m * static_cast<double>(i)));
        char row[32];
        std::snprintf(row, sizeof(row), "%.6e\n", 0.1 * static_cast<double>(i));
        times += row;
    }
    writeText(folder / "times.txt", times);
    writeText(folder / "calib.txt",
              "P0: 1 0 0 0 0 1 0 0 0 0 1 0\nTr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n");
    io::writeKitti(cam0, folder / "poses.txt");
}

void writeFloats(const fs::path& file, const Floats& values) {
    writeText(file, std::string(reinterpret_cast<const char*>(values.data()),
                                values.size() * sizeof(float)));
}

std::string scanName(std::size_t number) {
    char name[32];
    std::snprintf(name, sizeof(name), "%06zu.bin", number);
    return name;
}

std::vector<std::string> namesIn(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        names.push_back(fs::relative(entry.path(), folder));
    std::sort(names.begin(), names.end());
    return names;
}

std::vector<std::string> linesOf(const std::string& text) {
    std::istringstream in(text);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}
}  // namespace delio::test
