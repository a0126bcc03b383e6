#include "delio/map/ply.h"

#include <array>
#include <sstream>

#include "delio/core/numbers.h"
#include "point_file.h"

namespace delio::map {
namespace {
/** A type of the format, by both of its names. */
struct Type {
    const char *name, *sized;
    char kind;
    std::size_t bytes;
};
const std::array<Type, 8> kTypes{{{"char", "int8", 'I', 1},
                                  {"uchar", "uint8", 'U', 1},
                                  {"short", "int16", 'I', 2},
                                  {"ushort", "uint16", 'U', 2},
                                  {"int", "int32", 'I', 4},
                                  {"uint", "uint32", 'U', 4},
                                  {"float", "float32", 'F', 4},
                                  {"double", "float64", 'F', 8}}};

struct Header {
    bool ascii = false;
    std::size_t vertices = 0;
    std::vector<Column> columns;
};

Column columnOf(const std::string& type, const std::string& name, const PointFile& file) {
    for (const auto& known : kTypes)
        if (type == known.name || type == known.sized) return {name, known.kind, known.bytes};
    file.refuse("a vertex has a property of type '" + type + "'");
}

/** Reads up to and including `end_header`. Only the first element is looked at: it has to be the
 *  vertices. */
Header readHeader(PointFile& file) {
    Header header;
    unsigned element = 0;
    bool formatKnown = false;
    std::string line;
    for (unsigned row = 0; file.line(line); ++row) {
        if (row > 10000 || (row == 0 && line.substr(0, 3) != "ply")) break;
        std::istringstream words(line);
        std::string keyword, first, second;
        words >> keyword >> first >> second;
        if (keyword == "format") {
            header.ascii = first == "ascii";
            formatKnown = header.ascii || first == "binary_little_endian";
            if (!formatKnown) file.refuse("its format '" + first + "' is not supported");
        } else if (keyword == "element" && ++element == 1) {
            const auto count = numberIn<std::size_t>(second);
            if (first != "vertex" || !count)
                file.refuse("its first element has to be 'vertex' with a count");
            header.vertices = *count;
        } else if (keyword == "property" && element == 1) {
            header.columns.push_back(columnOf(first, second, file));
        } else if (keyword == "end_header") {
            if (!formatKnown || element == 0) break;
            return header;
        }
    }
    file.refuse("it has no whole header");
}

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
    const Header header = readHeader(file);
    return file.points(header.columns, header.vertices, header.ascii);
}
}  // namespace delio::map
