#include "formats/point_stream.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "delio/core/error.h"
#include "formats/las.h"
#include "formats/number_line.h"
#include "formats/pcd.h"
#include "formats/ply.h"

namespace delio::io {
namespace {
using Take = std::function<void(const Eigen::Vector3d&)>;
constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};

void takeFinite(const Eigen::Vector3d& point, const Take& take) {
    if (point.allFinite()) take(point);
}

void takeRecords(const CloudRecords& records, const RecordFile& file, const Take& take) {
    std::array<const PointField*, 3> axes{};
    for (std::size_t k = 0; k < 3; ++k) {
        for (const auto& field : records.layout.fields)
            if (!axes[k] && field.name == kAxes[k]) axes[k] = &field;
        if (!axes[k]) file.refuse("its points have no '" + std::string(kAxes[k]) + "'");
    }
    for (std::size_t i = 0; i < records.count; ++i) {
        const auto* record = &records.bytes[i * records.layout.step];
        Eigen::Vector3d point;
        for (Eigen::Index k = 0; k < 3; ++k) {
            const auto& axis = *axes[static_cast<std::size_t>(k)];
            point[k] = numberAt(record + axis.offset, axis.kind);
        }
        takeFinite(point, take);
    }
}

void takeBinary(RecordFile& file, const std::vector<Column>& columns, std::size_t count,
                const Take& take) {
    constexpr std::size_t kBlock = 65536;
    const std::size_t stride = strideOf(columns),
                      whole = stride == 0 ? 0 : file.bytesLeft() / stride;
    if (count > whole) file.refuseCut(whole, count);
    for (std::size_t done = 0; done < count; done += kBlock)
        takeRecords(readRecords(file, columns, std::min(kBlock, count - done), false), file, take);
}

void takeLines(RecordFile& file, const std::vector<Column>& columns, std::size_t count,
               const Take& take) {
    std::array<std::size_t, 3> axes{};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto isAxis = [&](const Column& column) {
            return plainName(column.name) == kAxes[k];
        };
        const auto found = std::find_if(columns.begin(), columns.end(), isAxis);
        if (found == columns.end())
            file.refuse("its points have no '" + std::string(kAxes[k]) + "'");
        axes[k] = static_cast<std::size_t>(found - columns.begin());
    }
    std::vector<double> values(columns.size());
    std::string line;
    for (std::size_t i = 0; i < count; ++i) {
        if (!file.line(line) || numbersIn(line, values) != columns.size()) file.refuseCut(i, count);
        takeFinite({values[axes[0]], values[axes[1]], values[axes[2]]}, take);
    }
}

void takePly(const std::string& path, const Take& take) {
    RecordFile file(path, "PLY");
    const auto header = readPlyHeader(file);
    if (header.bigEndian) file.refuse("its format 'binary_big_endian' is not supported");
    (header.ascii ? takeLines : takeBinary)(file, header.columns, header.vertices, take);
}

void takePcd(const std::string& path, const Take& take) {
    RecordFile file(path, "PCD");
    const auto header = readPcdHeader(file);
    const auto columns = columnsOf(header, file);
    if (header.data != "ascii" && header.data != "binary")
        return takeRecords(readPcdScan(path), file, take);
    if (!header.points) file.refuse("the number of points is missing");
    (header.data == "ascii" ? takeLines : takeBinary)(file, columns, *header.points, take);
}

std::string takeLas(const std::string& path, const Take& take) {
    LasReader las(path);
    las.forEach([&](const std::uint8_t* record) { takeFinite(las.position(record), take); });
    return las.header().wkt;
}
}  // namespace

std::string forEachPoint(const std::string& path, const Take& take) {
    const std::string kind = std::filesystem::path(path).extension().string();
    if (kind == ".las") return takeLas(path, take);
    if (kind == ".ply")
        takePly(path, take);
    else if (kind == ".pcd")
        takePcd(path, take);
    else
        throw Error("cannot read '" + path + "' as a point cloud: give a .ply, .pcd or .las file");
    return "";
}
}  // namespace delio::io
