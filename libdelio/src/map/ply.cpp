#include "delio/map/cloud_files.h"

#include "formats/ply.h"
#include "point_file.h"

namespace delio::map {
namespace {
void packColour(const mrpt::img::TColor& colour, char* to) {
    to[0] = static_cast<char>(colour.R);
    to[1] = static_cast<char>(colour.G);
    to[2] = static_cast<char>(colour.B);
}
}  // namespace

void savePly(const MapPoints& points, const std::string& path, const Colouring& colouring) {
    std::string header =
        "ply\nformat binary_little_endian 1.0\ncomment DeLiO map, metres\nelement vertex " +
        std::to_string(points.size()) + "\n";
    for (const auto& column : writtenColumns(false))
        header += "property " + std::string(column.kind == 'F' ? "float " : "ushort ") +
                  column.name + "\n";
    header += "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
    writePoints(path, header, points, coloursOf(points, colouring), 3, packColour);
}

MapPoints loadPly(const std::string& path) {
    PointFile file(path, "PLY");
    const auto header = io::readPlyHeader(file);
    if (header.bigEndian) file.refuse("its format 'binary_big_endian' is not supported");
    return file.points(header.columns, header.vertices, header.ascii);
}
}  // namespace delio::map
