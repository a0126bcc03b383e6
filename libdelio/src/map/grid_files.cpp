#include <filesystem>
#include <fstream>

#include "delio/core/error.h"
#include "delio/core/numbers.h"
#include "delio/files/output_file.h"
#include "delio/map/occupancy.h"
#include "mrpt/object_file.h"

namespace delio::map {
namespace fs = std::filesystem;
using mrpt::maps::COccupancyGridMap2D;

namespace {
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
        throw Error("cannot write '" + image + "': there is a folder of that name");
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
