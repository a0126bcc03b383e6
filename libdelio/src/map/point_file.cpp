#include "point_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <string_view>

#include "delio/core/text.h"
#include "delio/files/output.h"

namespace delio::map {
namespace {
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers are written as they lie here");

constexpr std::size_t kBlock = 4096;  // records that are read or written at once

/** A value of a point: how files name it, and how it goes into a point and out of it. */
struct Field {
    const char *ply, *pcd;
    float (*get)(const MapPoint&);
    void (*set)(MapPoint&, float);
};

// Floats all, as observations are in writing only.
const Field kFields[] = {
    {"x", "x", [](const MapPoint& p) { return p.position.x(); },
     [](MapPoint& p, float v) { p.position.x() = v; }},
    {"y", "y", [](const MapPoint& p) { return p.position.y(); },
     [](MapPoint& p, float v) { p.position.y() = v; }},
    {"z", "z", [](const MapPoint& p) { return p.position.z(); },
     [](MapPoint& p, float v) { p.position.z() = v; }},
    {"nx", "normal_x", [](const MapPoint& p) { return p.normal.x(); },
     [](MapPoint& p, float v) { p.normal.x() = v; }},
    {"ny", "normal_y", [](const MapPoint& p) { return p.normal.y(); },
     [](MapPoint& p, float v) { p.normal.y() = v; }},
    {"nz", "normal_z", [](const MapPoint& p) { return p.normal.z(); },
     [](MapPoint& p, float v) { p.normal.z() = v; }},
    {"intensity", "intensity", [](const MapPoint& p) { return p.intensity; },
     [](MapPoint& p, float v) { p.intensity = v; }},
    {"time", "time", [](const MapPoint& p) { return p.time_s; },
     [](MapPoint& p, float v) { p.time_s = v; }},
    {"residual", "residual", [](const MapPoint& p) { return p.residual_m; },
     [](MapPoint& p, float v) { p.residual_m = v; }},
    {"observations", "observations", nullptr,
     [](MapPoint& p, float v) {
         constexpr float kMost = std::numeric_limits<std::uint16_t>::max();
         p.observations = static_cast<std::uint16_t>(v > 0 ? std::min(v, kMost) : 0.0F);
     }},
};
constexpr std::size_t kPlaces = 3;  // of the fields: x, y and z

template <typename T>
float as(const char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return static_cast<float>(value);
}

using ReadNumber = float (*)(const char*);
ReadNumber readerOf(char kind, std::size_t bytes) {
    switch (kind) {
        case 'F':
            return bytes == 4 ? as<float> : bytes == 8 ? as<double> : ReadNumber{};
        case 'U':
            return bytes == 1   ? as<std::uint8_t>
                   : bytes == 2 ? as<std::uint16_t>
                   : bytes == 4 ? as<std::uint32_t>
                   : bytes == 8 ? as<std::uint64_t>
                                : ReadNumber{};
        case 'I':
            return bytes == 1   ? as<std::int8_t>
                   : bytes == 2 ? as<std::int16_t>
                   : bytes == 4 ? as<std::int32_t>
                   : bytes == 8 ? as<std::int64_t>
                                : ReadNumber{};
        default:
            return {};
    }
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

/** A field that the file has. */
struct Found {
    const Field* field;
    std::size_t column, offset;
    ReadNumber read;
};

void put(MapPoint& point, const Found& found, float value) {
    // What is not known of a point is 0; a place that is not finite drops it.
    if (!std::isfinite(value) && found.field >= kFields + kPlaces) value = 0;
    found.field->set(point, value);
}
}  // namespace

std::vector<Column> writtenColumns(bool pcd) {
    std::vector<Column> columns;
    for (const auto& field : kFields) {
        const std::string name = pcd ? field.pcd : field.ply;
        columns.push_back(field.get ? Column{name, 'F', 4} : Column{name, 'U', 2});
    }
    return columns;
}

void writePoints(const std::string& path, const std::string& header, const MapPoints& points,
                 const Colours& colours, std::size_t colourBytes,
                 void (*packColour)(const mrpt::img::TColor& colour, char* to)) {
    const std::size_t stride = colourBytes + io::strideOf(writtenColumns(false));
    io::replaceFile(path, [&](const std::string& temporary) {
        std::ofstream out(temporary, std::ios::binary);
        out << header;
        std::vector<char> block;
        for (std::size_t begin = 0; begin < points.size() && out; begin += kBlock) {
            const std::size_t end = std::min(begin + kBlock, points.size());
            block.resize((end - begin) * stride);
            char* to = block.data();
            for (std::size_t i = begin; i < end; ++i) {
                for (const auto& field : kFields) {
                    if (!field.get) continue;
                    const float value = field.get(points[i]);
                    to = std::copy_n(reinterpret_cast<const char*>(&value), sizeof(value), to);
                }
                const auto* seen = reinterpret_cast<const char*>(&points[i].observations);
                to = std::copy_n(seen, sizeof(points[i].observations), to);
                packColour(colours.ofPoints[i], to);
                to += colourBytes;
            }
            out.write(block.data(), static_cast<std::streamsize>(block.size()));
        }
        out.close();
        return static_cast<bool>(out);
    });
}

MapPoints PointFile::points(const std::vector<Column>& columns, std::size_t count, bool ascii) {
    std::vector<Found> found;
    for (const auto& field : kFields) {
        std::size_t offset = 0;
        const std::size_t before = found.size();
        for (std::size_t c = 0; c < columns.size(); offset += columns[c++].bytes)
            if (found.size() == before &&
                (columns[c].name == field.ply || columns[c].name == field.pcd))
                found.push_back({&field, c, offset, readerOf(columns[c].kind, columns[c].bytes)});
        if (&field < kFields + kPlaces && found.size() == before)
            refuse("its points have no '" + std::string(field.ply) + "'");
    }
    const std::size_t stride = io::strideOf(columns);
    // A header may claim too much: reserve at most what the file can hold.
    const std::size_t least = ascii ? 2 * columns.size() - 1 : stride;
    MapPoints points;
    points.reserve(std::min(count, (bytesLeft() + 1) / least));

    const auto keep = [&](const MapPoint& point) {
        if (point.position.allFinite()) points.push_back(point);
    };
    if (ascii) {
        std::vector<double> values(columns.size());
        std::string text;
        for (std::size_t i = 0; i < count; ++i) {
            if (!line(text) || !readNumbers(text, values)) refuseCut(i, count);
            MapPoint point;
            for (const auto& each : found)
                put(point, each, static_cast<float>(values[each.column]));
            keep(point);
        }
        return points;
    }
    std::vector<char> block(kBlock * stride);
    for (std::size_t done = 0; done < count;) {
        const std::size_t wanted = std::min(kBlock, count - done);
        stream().read(block.data(), static_cast<std::streamsize>(wanted * stride));
        const std::size_t whole = static_cast<std::size_t>(stream().gcount()) / stride;
        for (std::size_t i = 0; i < whole; ++i) {
            MapPoint point;
            for (const auto& each : found)
                put(point, each, each.read(block.data() + i * stride + each.offset));
            keep(point);
        }
        done += whole;
        if (whole < wanted) refuseCut(done, count);
    }
    return points;
}
}  // namespace delio::map
