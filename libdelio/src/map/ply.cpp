#include "delio/map/ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <locale>
#include <sstream>
#include <string_view>

#include "delio/core/error.h"
#include "delio/core/numbers.h"
#include "delio/io/output_file.h"

namespace delio::map {
using mrpt::maps::CPointsMap;
using mrpt::maps::CPointsMapXYZI;

namespace {
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "PLY is written as the machine has it");

constexpr std::size_t kWrittenVertex = 4 * sizeof(float) + 3;

struct Property {
    std::string name, type;
    std::size_t bytes = 0;
};

struct Header {
    bool ascii = false;
    std::size_t vertices = 0;
    std::vector<Property> properties;
};

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
    throw Error("'" + path + "' is not a PLY that can be read: " + why);
}

std::size_t bytesOf(const std::string& type) {
    if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") return 1;
    if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") return 2;
    if (type == "double" || type == "float64") return 8;
    for (const char* four : {"int", "uint", "float", "int32", "uint32", "float32"})
        if (type == four) return 4;
    return 0;
}

template <typename T>
double as(const char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return static_cast<double>(value);
}

double numberAt(const char* bytes, const std::string& type) {
    if (type == "float" || type == "float32") return as<float>(bytes);
    if (type == "double" || type == "float64") return as<double>(bytes);
    if (type == "uchar" || type == "uint8") return as<std::uint8_t>(bytes);
    if (type == "char" || type == "int8") return as<std::int8_t>(bytes);
    if (type == "ushort" || type == "uint16") return as<std::uint16_t>(bytes);
    if (type == "short" || type == "int16") return as<std::int16_t>(bytes);
    if (type == "uint" || type == "uint32") return as<std::uint32_t>(bytes);
    return as<std::int32_t>(bytes);
}

/** Reads up to and including `end_header`. Only the first element is looked at: it has to be the
 *  vertices. */
Header readHeader(std::istream& in, const std::string& path) {
    Header header;
    unsigned element = 0;
    bool formatKnown = false;
    std::string line;
    for (unsigned row = 0; std::getline(in, line); ++row) {
        if (row > 10000 || (row == 0 && line.substr(0, 3) != "ply")) break;
        std::istringstream words(line);
        std::string keyword, first, second, third;
        words >> keyword >> first >> second >> third;
        if (keyword == "format") {
            header.ascii = first == "ascii";
            formatKnown = header.ascii || first == "binary_little_endian";
            if (!formatKnown) refuse(path, "its format '" + first + "' is not supported");
        } else if (keyword == "element" && ++element == 1) {
            const auto count = numberIn<std::size_t>(second);
            if (first != "vertex" || !count)
                refuse(path, "its first element has to be 'vertex' with a count");
            header.vertices = *count;
        } else if (keyword == "property" && element == 1) {
            if (bytesOf(first) == 0)
                refuse(path, "a vertex has a property of type '" + first + "'");
            header.properties.push_back({second, first, bytesOf(first)});
        } else if (keyword == "end_header") {
            if (!formatKnown || element == 0) break;
            return header;
        }
    }
    refuse(path, "it has no whole header");
}

/** Where in a vertex the values that a map takes stand; intensity may be missing (-1). */
std::array<int, 4> findColumns(const Header& header, const std::string& path) {
    std::array<int, 4> columns{-1, -1, -1, -1};
    const std::array<std::string, 4> names{"x", "y", "z", "intensity"};
    for (std::size_t n = 0; n < names.size(); ++n)
        for (std::size_t p = 0; p < header.properties.size(); ++p)
            if (header.properties[p].name == names[n]) columns[n] = static_cast<int>(p);
    for (std::size_t n = 0; n < 3; ++n)
        if (columns[n] < 0) refuse(path, "its vertices have no '" + names[n] + "'");
    return columns;
}

/** Reads the numbers that a line begins with, as many as `values` holds; false if they are fewer.
 */
bool readNumbers(std::string_view line, std::vector<double>& values) {
    constexpr const char* kSpaces = " \t\r";
    for (auto& value : values) {
        line.remove_prefix(std::min(line.find_first_not_of(kSpaces), line.size()));
        const auto word = line.substr(0, line.find_first_of(kSpaces));
        const auto number = numberIn<double>(word);
        if (!number) return false;
        value = *number;
        line.remove_prefix(word.size());
    }
    return true;
}
}  // namespace

void savePly(const CPointsMap& points, const std::string& path, Colormap colormap) {
    const auto& x = points.getPointsBufferRef_x();
    const auto& y = points.getPointsBufferRef_y();
    const auto& z = points.getPointsBufferRef_z();
    const auto* withIntensity = dynamic_cast<const CPointsMapXYZI*>(&points);
    const ValueRange heights = robustRange({z.begin(), z.end()});

    io::replaceFile(path, [&](const std::string& temporary) {
        std::ofstream out(temporary, std::ios::binary);
        out.imbue(std::locale::classic());
        out << "ply\nformat binary_little_endian 1.0\ncomment DeLiO map, metres\nelement vertex "
            << x.size()
            << "\nproperty float x\nproperty float y\nproperty float z\nproperty float intensity\n"
               "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
        for (std::size_t i = 0; i < x.size(); ++i) {
            const float intensity = withIntensity ? withIntensity->getPointIntensity_fast(i) : 0;
            const float numbers[4] = {x[i], y[i], z[i], intensity};
            const auto colour = colourAt(colormap, heights.fractionAt(z[i]));
            char vertex[kWrittenVertex];
            std::memcpy(vertex, numbers, sizeof(numbers));
            vertex[16] = static_cast<char>(colour.R);
            vertex[17] = static_cast<char>(colour.G);
            vertex[18] = static_cast<char>(colour.B);
            out.write(vertex, sizeof(vertex));
        }
        out.close();
        return static_cast<bool>(out);
    });
}

CPointsMapXYZI loadPly(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    if (!in) throw Error("cannot read '" + path + "': there is no such file");
    in.imbue(std::locale::classic());
    const Header header = readHeader(in, path);
    const auto columns = findColumns(header, path);

    std::vector<std::size_t> offsets;
    std::size_t stride = 0;
    for (const auto& property : header.properties) {
        offsets.push_back(stride);
        stride += property.bytes;
    }
    CPointsMapXYZI map;
    std::vector<char> bytes(stride);
    std::vector<double> values(header.properties.size());
    std::string line;
    for (std::size_t i = 0; i < header.vertices; ++i) {
        bool whole = true;
        if (header.ascii) {
            whole = std::getline(in, line) && readNumbers(line, values);
        } else {
            whole = static_cast<bool>(in.read(bytes.data(), static_cast<std::streamsize>(stride)));
            for (std::size_t p = 0; p < values.size(); ++p)
                values[p] = numberAt(bytes.data() + offsets[p], header.properties[p].type);
        }
        if (!whole)
            refuse(path, "it is cut off or malformed after " + std::to_string(i) + " of " +
                             std::to_string(header.vertices) + " points");
        const auto value = [&](std::size_t n) {
            return columns[n] < 0
                       ? 0.0F
                       : static_cast<float>(values[static_cast<std::size_t>(columns[n])]);
        };
        if (std::isfinite(value(0)) && std::isfinite(value(1)) && std::isfinite(value(2)))
            map.insertPointRGB(value(0), value(1), value(2), value(3), 0, 0);
    }
    return map;
}
}  // namespace delio::map
