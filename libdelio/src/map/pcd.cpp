#include "delio/map/pcd.h"

#include <cstring>
#include <optional>
#include <sstream>

#include "delio/core/numbers.h"
#include "point_file.h"

namespace delio::map {
namespace {
/** As PCL does: 0x00rrggbb in the bytes of a float. */
void packColour(const mrpt::img::TColor& colour, char* to) {
    const std::uint32_t rgb =
        std::uint32_t{colour.R} << 16 | std::uint32_t{colour.G} << 8 | colour.B;
    std::memcpy(to, &rgb, sizeof(rgb));
}

struct Header {
    std::vector<std::string> names, sizes, types, counts;
    std::optional<std::size_t> points;
    std::string data;
};

/** Reads up to and including the line `DATA`. */
Header readHeader(PointFile& file) {
    Header header;
    std::optional<std::size_t> width, height;
    std::string line;
    for (unsigned row = 0; row < 1000 && file.line(line); ++row) {
        std::istringstream words(line);
        std::string keyword, word;
        if (!(words >> keyword) || keyword[0] == '#') continue;
        std::vector<std::string> rest;
        while (words >> word) rest.push_back(word);
        const auto number = numberIn<std::size_t>(rest.empty() ? "" : rest[0]);
        if (keyword == "FIELDS" || keyword == "COLUMNS")
            header.names = rest;
        else if (keyword == "SIZE")
            header.sizes = rest;
        else if (keyword == "TYPE")
            header.types = rest;
        else if (keyword == "COUNT")
            header.counts = rest;
        else if (keyword == "WIDTH")
            width = number;
        else if (keyword == "HEIGHT")
            height = number;
        else if (keyword == "POINTS")
            header.points = number;
        else if (keyword == "DATA" && !rest.empty()) {
            header.data = rest[0];
            if (!header.points && width && height) header.points = *width * *height;
            return header;
        } else if (keyword != "VERSION" && keyword != "VIEWPOINT")
            break;
    }
    file.refuse("it has no whole header");
}

/** A field with a count of more than one is as many columns, of which the first has its name. */
std::vector<Column> columnsOf(const Header& header, const PointFile& file) {
    const std::size_t fields = header.names.size();
    if (fields == 0 || header.sizes.size() != fields || header.types.size() != fields ||
        (!header.counts.empty() && header.counts.size() != fields))
        file.refuse("FIELDS, SIZE, TYPE and COUNT do not have as many words");
    std::vector<Column> columns;
    for (std::size_t i = 0; i < fields; ++i) {
        const auto bytes = numberIn<std::size_t>(header.sizes[i]);
        const auto count =
            numberIn<std::size_t>(header.counts.empty() ? std::string("1") : header.counts[i]);
        constexpr std::size_t kMost = 4096;  // PCL's descriptors have some hundreds
        if (!bytes || header.types[i].size() != 1 || !isNumber(header.types[i][0], *bytes) ||
            !count || *count > kMost)
            file.refuse("its field '" + header.names[i] + "' is of no known type");
        for (std::size_t k = 0; k < *count; ++k)
            columns.push_back({k == 0 ? header.names[i] : "", header.types[i][0], *bytes});
    }
    return columns;
}
}  // namespace

void savePcd(const MapPoints& points, const std::string& path, const Colouring& colouring) {
    std::string names, sizes, types, counts;
    auto columns = writtenColumns(true);
    columns.push_back({"rgb", 'F', 4});
    for (const auto& column : columns) {
        names += " " + column.name;
        sizes += " " + std::to_string(column.bytes);
        types += std::string(" ") + column.kind;
        counts += " 1";
    }
    const std::string count = std::to_string(points.size());
    const std::string header = "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS" +
                               names + "\nSIZE" + sizes + "\nTYPE" + types + "\nCOUNT" + counts +
                               "\nWIDTH " + count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
                               count + "\nDATA binary\n";
    writePoints(path, header, points, coloursOf(points, colouring), 4, packColour);
}

MapPoints loadPcd(const std::string& path) {
    PointFile file(path, "PCD");
    const Header header = readHeader(file);
    if (header.data == "binary_compressed")
        file.refuse(
            "its data is compressed; write it once more as ascii or binary "
            "(pcl_convert_pcd_ascii_binary IN.pcd OUT.pcd 1)");
    if (header.data != "ascii" && header.data != "binary")
        file.refuse("its data is '" + header.data + "'");
    if (!header.points) file.refuse("it does not say how many points it has");
    return file.points(columnsOf(header, file), *header.points, header.data == "ascii");
}
}  // namespace delio::map
