#include "pcd.h"

#include <liblzf/lzf.h>

#include <algorithm>
#include <array>
#include <limits>
#include <sstream>

#include "delio/core/text.h"
#include "files/input_file.h"

namespace delio::io {
namespace {
/** Decompressed data: all values of the first field, then all of the second, and so on. */
std::vector<std::uint8_t> decompressed(RecordFile& file, std::size_t count, std::size_t stride) {
    std::array<std::uint32_t, 2> sizes{};  // compressed, and not
    const std::size_t left = file.bytesLeft();
    file.stream().read(reinterpret_cast<char*>(sizes.data()), sizeof(sizes));
    if (left < sizeof(sizes) || !file.stream() || sizes[0] > left - sizeof(sizes))
        file.refuseCut(0, count);
    constexpr std::size_t kMostShrunk = 88;  // LZF's 3 bytes for 264
    if (sizes[1] / stride != count || sizes[1] % stride != 0 || sizes[1] / kMostShrunk > sizes[0] ||
        sizes[1] > kMostBytes)
        file.refuse("the data size does not match " + std::to_string(count) + " points");
    std::vector<std::uint8_t> packed(sizes[0]), bytes(sizes[1]);
    file.stream().read(reinterpret_cast<char*>(packed.data()),
                       static_cast<std::streamsize>(packed.size()));
    if (!bytes.empty() &&
        lzf_decompress(packed.data(), sizes[0], bytes.data(), sizes[1]) != sizes[1])
        file.refuse("the compressed data is damaged");
    return bytes;
}

CloudRecords readCompressed(RecordFile& file, const std::vector<Column>& columns,
                            std::size_t count) {
    CloudRecords records{layoutOf(columns), {}, count, 1};
    const std::size_t step = records.layout.step;
    if (step == 0) file.refuse("the points have no fields");
    const auto byField = decompressed(file, count, step);
    records.bytes.resize(byField.size());
    const std::uint8_t* from = byField.data();
    std::size_t offset = 0;
    for (const auto& column : columns) {
        for (std::size_t i = 0; i < count; ++i, from += column.bytes)
            std::copy_n(from, column.bytes, &records.bytes[i * step + offset]);
        offset += column.bytes;
    }
    makeDoubles(columns, records);
    return records;
}

/** A field of several numbers lies together in compressed data, point by point. */
std::vector<Column> fieldsOf(const std::vector<Column>& columns) {
    std::vector<Column> fields;
    for (const auto& column : columns)
        if (column.name.empty() && !fields.empty())
            fields.back() = {"_", 'U', fields.back().bytes + column.bytes};
        else
            fields.push_back(column);
    return fields;
}

/** Points that a file of which the header does not say it holds. */
std::size_t countIn(RecordFile& file, const PcdHeader& header, std::size_t stride) {
    if (header.data == "binary") return stride > 0 ? file.bytesLeft() / stride : 0;
    const auto begin = file.stream().tellg();
    std::size_t count = 0;
    if (header.data == "binary_compressed") {
        std::array<std::uint32_t, 2> sizes{};
        file.stream().read(reinterpret_cast<char*>(sizes.data()), sizeof(sizes));
        if (file.stream() && stride > 0) count = sizes[1] / stride;
    } else {
        for (std::string line; file.line(line);)
            count += line.find_first_not_of(" \t\r") != line.npos;
    }
    file.stream().clear();
    file.stream().seekg(begin);
    return count;
}

/** A width and height of 0 are how some programs write a cloud whose size they do not know yet. */
std::size_t countOf(const PcdHeader& header, RecordFile& file, std::size_t stride) {
    const bool isSized = header.width.value_or(0) > 0 && header.height.value_or(0) > 0;
    if (!isSized) {
        if (header.points.value_or(0) > 0) return *header.points;
        return countIn(file, header, stride);
    }
    const std::size_t width = *header.width, height = *header.height;
    if (height > std::numeric_limits<std::size_t>::max() / width ||
        width * height != header.points.value_or(width * height))
        file.refuse("it has " + std::to_string(header.points.value_or(0)) + " points, but " +
                    std::to_string(width) + " by " + std::to_string(height));
    return width * height;
}
}  // namespace

CloudRecords readPcdScan(const std::string& path) {
    RecordFile file(path, "PCD");
    if (file.bytesLeft() == 0) file.refuse("the file is empty");
    const auto header = readPcdHeader(file);
    const auto columns = columnsOf(header, file);
    const std::size_t count = countOf(header, file, strideOf(columns));
    CloudRecords records;
    if (header.data == "binary_compressed")
        records = readCompressed(file, fieldsOf(columns), count);
    else if (header.data == "ascii" || header.data == "binary")
        records = readRecords(file, columns, count, header.data == "ascii");
    else
        file.refuse("unsupported DATA '" + header.data + "'");
    if (header.width.value_or(0) > 0 && header.height.value_or(0) > 0)
        records.rows = *header.height;
    return records;
}

PcdHeader readPcdHeader(RecordFile& file) {
    PcdHeader header;
    std::string line;
    for (unsigned row = 0; row < 1000 && file.line(line); ++row) {
        std::istringstream words(line);
        std::string keyword, word;
        if (!(words >> keyword) || keyword[0] == '#') continue;
        std::vector<std::string> rest;
        while (words >> word) rest.push_back(word);
        const auto number = numberIn<std::size_t>(rest.empty() ? "" : rest[0]);
        const bool isCount = keyword == "WIDTH" || keyword == "HEIGHT" || keyword == "POINTS";
        if (isCount && !number) file.refuse("its " + keyword + " is not a number of points");
        if (keyword == "FIELDS" || keyword == "COLUMNS")
            header.names = rest;
        else if (keyword == "SIZE")
            header.sizes = rest;
        else if (keyword == "TYPE")
            header.types = rest;
        else if (keyword == "COUNT")
            header.counts = rest;
        else if (keyword == "WIDTH")
            header.width = number;
        else if (keyword == "HEIGHT")
            header.height = number;
        else if (keyword == "POINTS")
            header.points = number;
        else if (keyword == "DATA" && !rest.empty()) {
            header.data = rest[0];
            if (!header.points && header.width && header.height)
                header.points = *header.width * *header.height;
            return header;
        } else if (keyword == "VIEWPOINT")
            header.viewpoint = rest;
        else if (keyword != "VERSION")
            break;
    }
    file.refuse("the header is incomplete");
}

std::vector<Column> columnsOf(const PcdHeader& header, const RecordFile& file) {
    const std::size_t fields = header.names.size();
    if (fields == 0 || header.sizes.size() != fields || header.types.size() != fields ||
        (!header.counts.empty() && header.counts.size() != fields))
        file.refuse("FIELDS, SIZE, TYPE and COUNT have different lengths");
    std::vector<Column> columns;
    for (std::size_t i = 0; i < fields; ++i) {
        const auto bytes = numberIn<std::size_t>(header.sizes[i]);
        const auto count =
            numberIn<std::size_t>(header.counts.empty() ? std::string("1") : header.counts[i]);
        constexpr std::size_t kMost = 4096;  // PCL's descriptors have some hundreds
        if (!bytes || header.types[i].size() != 1 || !isNumber(header.types[i][0], *bytes) ||
            !count || *count > kMost)
            file.refuse("its field '" + header.names[i] + "' has an unknown type");
        for (std::size_t k = 0; k < *count; ++k)
            columns.push_back({k == 0 ? header.names[i] : "", header.types[i][0], *bytes});
    }
    return columns;
}
}  // namespace delio::io
