#include "delio/map/occupancy.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "delio/core/error.h"
#include "delio/core/text.h"
#include "delio/files/output.h"
#include "map/ground.h"
#include "mrpt/object_file.h"

namespace delio::map {
namespace fs = std::filesystem;
using mrpt::maps::COccupancyGridMap2D;

namespace {
constexpr double kGroundCell_m = 1;
constexpr double kDeepest_m = -0.5;    // below the ground are reflections
constexpr double kLongestStep_m = 10;  // between poses: over more than that nobody knows the way
// Cell states during construction.
enum Mark : COccupancyGridMap2D::cellType {
    kUnknown,
    kGround,
    kNearGround,
    kSeenThrough,
    kOccupied,
    kDriven
};

/** A grid in the making: cells by number from that of the lowest corner. */
class Marks {
 public:
    Marks(const Eigen::AlignedBox2d& extent, double resolution);

    void mark(double x, double y, Mark mark);
    /** The cells whose middle is no farther than that. */
    void markDisc(const Eigen::Vector2d& middle, double radius, Mark mark);
    /** Marks what is no more than `reach` cells, along x and along y, from the ground. */
    void widenGround(int reach);
    /** Marks the cells on the line from `from` to `to`, without the last one, where the line is
     *  not higher above the ground than `height`, nor deep below it. */
    void markRay(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                 const GroundSurface& ground, double height);
    COccupancyGridMap2D grid();

 private:
    std::int64_t numberOf(double v) const {
        return static_cast<std::int64_t>(std::floor(v / resolution_));
    }
    void widenAlongY(int reach);
    void widenAlongX(int reach);

    double resolution_;
    std::int64_t firstX_ = 0, firstY_ = 0;
    int width_ = 0, height_ = 0;
    COccupancyGridMap2D grid_;
};

Marks::Marks(const Eigen::AlignedBox2d& extent, double resolution) : resolution_(resolution) {
    const double width = extent.sizes().x() / resolution + 1;
    const double height = extent.sizes().y() / resolution + 1;
    if (width * height > kMostCells)
        throw Error("the grid would have " + digitsOf(std::round(width)) + " x " +
                    digitsOf(std::round(height)) + " cells, more than " +
                    digitsOf(std::round(kMostCells / 1e6)) +
                    " million; use a coarser --resolution or --crop");
    firstX_ = numberOf(extent.min().x());
    firstY_ = numberOf(extent.min().y());
    const auto corner = [&](std::int64_t number) {
        return static_cast<float>(static_cast<double>(number) * resolution);
    };
    grid_.setSize(corner(firstX_), corner(numberOf(extent.max().x()) + 1), corner(firstY_),
                  corner(numberOf(extent.max().y()) + 1), static_cast<float>(resolution));
    width_ = static_cast<int>(grid_.getSizeX());
    height_ = static_cast<int>(grid_.getSizeY());
    for (int row = 0; row < height_; ++row) std::fill_n(grid_.getRow(row), width_, kUnknown);
}

void Marks::mark(double x, double y, Mark mark) {
    const std::int64_t column = numberOf(x) - firstX_, row = numberOf(y) - firstY_;
    if (column < 0 || row < 0 || column >= width_ || row >= height_) return;
    auto& cell = grid_.getRow(static_cast<int>(row))[column];
    if (mark > cell) cell = mark;
}

void Marks::markDisc(const Eigen::Vector2d& middle, double radius, Mark mark) {
    const auto middleOf = [&](double v) {
        return (static_cast<double>(numberOf(v)) + 0.5) * resolution_;
    };
    const double fromY = middleOf(middle.y() - radius), fromX = middleOf(middle.x() - radius);
    for (double y = fromY; y <= middle.y() + radius; y += resolution_)
        for (double x = fromX; x <= middle.x() + radius; x += resolution_)
            if ((Eigen::Vector2d(x, y) - middle).norm() <= radius) this->mark(x, y, mark);
}

void Marks::widenAlongY(int reach) {
    // Forth and back, with the latest row of each column that has ground.
    for (const int step : {1, -1}) {
        std::vector<int> sinceGround(static_cast<std::size_t>(width_), reach + 1);
        for (int i = 0; i < height_; ++i) {
            auto* row = grid_.getRow(step > 0 ? i : height_ - 1 - i);
            for (int x = 0; x < width_; ++x) {
                int& since = sinceGround[static_cast<std::size_t>(x)];
                since = row[x] == kGround ? 0 : std::min(since + 1, reach + 1);
                if (row[x] == kUnknown && since <= reach) row[x] = kNearGround;
            }
        }
    }
}

void Marks::widenAlongX(int reach) {
    std::vector<std::uint8_t> ground(static_cast<std::size_t>(width_));
    for (int y = 0; y < height_; ++y) {
        auto* row = grid_.getRow(y);
        for (int x = 0; x < width_; ++x)
            ground[static_cast<std::size_t>(x)] = row[x] == kGround || row[x] == kNearGround;
        for (const int step : {1, -1}) {
            int since = reach + 1;
            for (int i = 0; i < width_; ++i) {
                const int x = step > 0 ? i : width_ - 1 - i;
                since = ground[static_cast<std::size_t>(x)] ? 0 : std::min(since + 1, reach + 1);
                if (row[x] == kUnknown && since <= reach) row[x] = kNearGround;
            }
        }
    }
}

void Marks::widenGround(int reach) {
    widenAlongY(reach);
    widenAlongX(reach);
}

/** One cell for each step along the longer axis, as Bresenham's line has it. */
void Marks::markRay(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                    const GroundSurface& ground, double height) {
    const Eigen::Vector3d way = to - from;
    const std::int64_t column = numberOf(from.x()) - firstX_, row = numberOf(from.y()) - firstY_,
                       columns = numberOf(to.x()) - firstX_ - column,
                       rows = numberOf(to.y()) - firstY_ - row;
    const auto steps = static_cast<double>(std::max(std::abs(columns), std::abs(rows)));
    const auto groundAt = [&](const Eigen::Vector3d& at) {
        return ground.isGround(at.x(), at.y()) ? ground.at(at.x(), at.y()) : std::nan("");
    };
    // About the sensor often no ground was seen: there it is as where the line meets it first.
    double below = std::nan("");
    const double leap = std::max(1.0, kGroundCell_m / resolution_);
    for (double step = 0; step < steps && std::isnan(below); step += leap)
        below = groundAt(from + way * (step / steps));
    for (double step = 0; step < steps; ++step) {
        const double part = step / steps;
        const std::int64_t x = column + std::llround(part * static_cast<double>(columns)),
                           y = row + std::llround(part * static_cast<double>(rows));
        if (x < 0 || y < 0 || x >= width_ || y >= height_) continue;
        auto& cell = grid_.getRow(static_cast<int>(y))[x];
        if (cell >= kSeenThrough) continue;
        // Where it was not seen farther on, it stays as it was.
        const Eigen::Vector3d at = from + way * part;
        const double here = groundAt(at);
        if (!std::isnan(here)) below = here;
        const double above = at.z() - below;
        if (above >= kDeepest_m && above <= height) cell = kSeenThrough;
    }
}

COccupancyGridMap2D Marks::grid() {
    const auto unknown = COccupancyGridMap2D::p2l(0.5F), free = COccupancyGridMap2D::p2l(0.98F),
               occupied = COccupancyGridMap2D::p2l(0.02F);
    for (int y = 0; y < height_; ++y) {
        auto* row = grid_.getRow(y);
        for (int x = 0; x < width_; ++x)
            row[x] = row[x] == kUnknown ? unknown : row[x] == kOccupied ? occupied : free;
    }
    return std::move(grid_);
}

Eigen::AlignedBox2d extentOf(const MapPoints& points,
                             const std::vector<std::vector<Eigen::Isometry3d>>& ways,
                             double margin) {
    Eigen::AlignedBox2d box;
    for (const auto& point : points) box.extend(point.position.head<2>().cast<double>());
    for (const auto& way : ways)
        for (const auto& pose : way) {
            const Eigen::Vector2d at = pose.translation().head<2>();
            box.extend(Eigen::Vector2d(at.array() - margin));
            box.extend(Eigen::Vector2d(at.array() + margin));
        }
    return box;
}

void markWay(const std::vector<Eigen::Isometry3d>& way, const OccupancyOptions& options,
             Marks& marks) {
    for (std::size_t i = 0; i < way.size(); ++i) {
        const Eigen::Vector2d to = way[i].translation().head<2>();
        Eigen::Vector2d from = way[i > 0 ? i - 1 : 0].translation().head<2>();
        if ((to - from).norm() > kLongestStep_m) from = to;
        const int steps = 1 + static_cast<int>((to - from).norm() / (options.resolution_m / 2));
        for (int k = 1; k <= steps; ++k)
            marks.markDisc(from + (to - from) * k / steps, options.halfWidth_m, kDriven);
    }
}
/** From where the sensor was when each point was seen first, to the point. */
void markRays(const MapPoints& points, const io::Trajectory& sensor, const GroundSurface& ground,
              const OccupancyOptions& options, Marks& marks) {
    constexpr double kNear_s = 0.05;
    const auto& stamps_s = sensor.stamps_s;
    for (const auto& point : points) {
        const double time_s = double{point.time_s};
        const auto next = std::lower_bound(stamps_s.begin(), stamps_s.end(), time_s - kNear_s);
        if (next == stamps_s.end() || *next > time_s + kNear_s) continue;
        marks.markRay(sensor.poses[static_cast<std::size_t>(next - stamps_s.begin())].translation(),
                      point.position.cast<double>(), ground, options.height_m);
    }
}

// map_server takes a cell for occupied, or free, from these on.
constexpr double kOccupiedFrom = 0.65, kFreeBelow = 0.196;

std::uint8_t shadeOf(double free) {
    if (1 - free > kOccupiedFrom) return 0;
    return 1 - free < kFreeBelow ? 254 : 205;
}

bool writeImage(const COccupancyGridMap2D& grid, const std::string& path) {
    const int width = static_cast<int>(grid.getSizeX()), height = static_cast<int>(grid.getSizeY());
    std::ofstream out(path, std::ios::binary);
    out << "P5\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n";
    std::string row(static_cast<std::size_t>(width), '\0');
    for (int y = height - 1; y >= 0 && out; --y) {
        for (int x = 0; x < width; ++x)
            row[static_cast<std::size_t>(x)] =
                static_cast<char>(shadeOf(double{grid.getCell(x, y)}));
        out << row;
    }
    out.close();
    return static_cast<bool>(out);
}

/** In double quotes, as YAML has it. */
std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        result += c;
    }
    return result + "\"";
}
}  // namespace

COccupancyGridMap2D occupancyGrid(const MapPoints& points,
                                  const std::vector<std::vector<Eigen::Isometry3d>>& ways,
                                  const OccupancyOptions& options, const io::Trajectory& sensor) {
    if (points.empty()) throw Error("the map has no points for a grid");
    Marks marks(extentOf(points, ways, options.halfWidth_m), options.resolution_m);
    // Not finer than two cells of the grid: memory stays within a few times that of the grid.
    const GroundSurface ground(points, std::max(kGroundCell_m, 2 * options.resolution_m));
    for (const auto& point : points) {
        const double x = double{point.position.x()}, y = double{point.position.y()};
        const double height = double{point.position.z()} - ground.at(x, y);
        if (height >= options.low_m && height <= options.height_m)
            marks.mark(x, y, kOccupied);
        else if (height >= kDeepest_m && height < options.low_m && ground.isGround(x, y))
            marks.mark(x, y, kGround);
    }
    marks.widenGround(static_cast<int>(std::lround(options.groundReach_m / options.resolution_m)));
    markRays(points, sensor, ground, options, marks);
    for (const auto& way : ways) markWay(way, options, marks);
    return marks.grid();
}

void saveGridmap(const COccupancyGridMap2D& grid, const std::string& path) {
    io::saveWhole(grid, path);
}

std::string imageBeside(const std::string& yaml) {
    return fs::path(yaml).replace_extension(".pgm").string();
}

void saveMapServer(const COccupancyGridMap2D& grid, const std::string& path) {
    const std::string image = imageBeside(path);
    std::error_code ignored;
    if (fs::is_directory(image, ignored))
        throw Error("cannot write '" + image + "': a folder has this name");
    // One within the other: both are whole under their temporary names before either is renamed.
    io::replaceFile(image, [&](const std::string& temporary) {
        if (!writeImage(grid, temporary)) return false;
        io::replaceTextFile(path, [&](std::ostream& out) {
            out << "image: " << quoted(fs::path(image).filename().string())
                << "\nresolution: " << digitsOf(grid.getResolution()) << "\norigin: ["
                << digitsOf(grid.getXMin()) << ", " << digitsOf(grid.getYMin())
                << ", 0]\nnegate: 0\noccupied_thresh: " << digitsOf(kOccupiedFrom)
                << "\nfree_thresh: " << digitsOf(kFreeBelow) << "\nmode: trinary\n";
        });
        return true;
    });
}
}  // namespace delio::map
