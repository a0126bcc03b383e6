#include "osf_writer.h"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace delio::test {
namespace {
template <typename Number>
std::string raw(Number value) {
    return std::string(reinterpret_cast<const char*>(&value), sizeof(value));
}

template <typename Number>
void patch(std::string& out, std::size_t at, Number value) {
    std::memcpy(&out[at], &value, sizeof(value));
}

void point(std::string& out, std::size_t from) {
    patch(out, from, static_cast<std::uint32_t>(out.size() - from));
}

/** Bytes before a table that tell the places of its fields. */
std::size_t placesOf(const FlatTree& tree) {
    std::size_t most = 0;
    for (const auto& field : tree.fields) most = std::max(most, field.number + 1);
    return 4 + 2 * most;
}

void writeTable(std::string& out, const FlatTree& tree) {
    const std::size_t places = out.size(), table = places + placesOf(tree);
    out.resize(table);
    patch(out, places, static_cast<std::uint16_t>(table - places));
    out += raw(static_cast<std::int32_t>(table - places));
    std::vector<std::size_t> at;
    for (const auto& field : tree.fields) {
        patch(out, places + 4 + 2 * field.number, static_cast<std::uint16_t>(out.size() - table));
        at.push_back(out.size());
        out += field.kind == FlatTree::Field::Kind::kScalar ? field.scalar : std::string(4, '\0');
    }
    patch(out, places + 2, static_cast<std::uint16_t>(out.size() - table));
    for (std::size_t i = 0; i < at.size(); ++i) {
        const auto& field = tree.fields[i];
        if (field.kind == FlatTree::Field::Kind::kScalar) continue;
        point(out, at[i]);
        if (field.kind == FlatTree::Field::Kind::kVector) {
            out += raw(static_cast<std::uint32_t>(field.count)) + field.vector;
            continue;
        }
        out += raw(static_cast<std::uint32_t>(field.tables.size()));
        const std::size_t children = out.size();
        out.resize(children + 4 * field.tables.size());
        for (std::size_t k = 0; k < field.tables.size(); ++k) {
            patch(out, children + 4 * k,
                  static_cast<std::uint32_t>(out.size() + placesOf(field.tables[k]) -
                                             (children + 4 * k)));
            writeTable(out, field.tables[k]);
        }
    }
}

std::string bigEndian(std::uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 255U);
    return bytes;
}

std::string pngChunk(const std::string& type, const std::string& data) {
    const std::string summed = type + data;
    const auto sum = crc32_z(0, reinterpret_cast<const Bytef*>(summed.data()), summed.size());
    return bigEndian(static_cast<std::uint32_t>(data.size())) + summed +
           bigEndian(static_cast<std::uint32_t>(sum));
}

std::uint8_t nearest(int left, int above, int aboveLeft) {
    const int guess = left + above - aboveLeft;
    const std::array<int, 3> all{left, above, aboveLeft};
    return static_cast<std::uint8_t>(*std::min_element(
        all.begin(), all.end(),
        [guess](int one, int other) { return std::abs(guess - one) < std::abs(guess - other); }));
}

/** Rows of bytes, each behind the number of its filter. */
std::string filtered(const std::vector<std::string>& rows, std::size_t pixel) {
    std::string out;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        const std::size_t filter = r % 5;
        out += static_cast<char>(filter);
        const auto at = [&](std::size_t row, std::size_t i) {
            return static_cast<int>(static_cast<std::uint8_t>(rows[row][i]));
        };
        for (std::size_t i = 0; i < rows[r].size(); ++i) {
            const int left = i < pixel ? 0 : at(r, i - pixel), above = r == 0 ? 0 : at(r - 1, i),
                      aboveLeft = i < pixel || r == 0 ? 0 : at(r - 1, i - pixel);
            const std::array<int, 5> taken{0, left, above, (left + above) / 2,
                                           nearest(left, above, aboveLeft)};
            out += static_cast<char>(at(r, i) - taken[filter]);
        }
    }
    return out;
}

std::string png(std::size_t rows, std::size_t columns, std::size_t bytes,
                const std::vector<std::uint32_t>& pixels) {
    std::vector<std::string> lines(rows);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        std::string number = raw(pixels[i]).substr(0, bytes);
        if (bytes == 2) std::reverse(number.begin(), number.end());
        lines[i / columns] += number;
    }
    const std::string data = filtered(lines, bytes);
    std::string packed(compressBound(data.size()), '\0');
    uLongf size = packed.size();
    compress(reinterpret_cast<Bytef*>(packed.data()), &size,
             reinterpret_cast<const Bytef*>(data.data()), data.size());
    packed.resize(size);
    const std::string kinds[] = {"", {"\x08\0", 2}, {"\x10\0", 2}, "\x08\x02", "\x08\x06"};
    return "\x89PNG\r\n\x1a\n" +
           pngChunk("IHDR", bigEndian(static_cast<std::uint32_t>(columns)) +
                                bigEndian(static_cast<std::uint32_t>(rows)) + kinds[bytes] +
                                std::string(3, '\0')) +
           pngChunk("IDAT", packed.substr(0, size / 2)) +
           pngChunk("IDAT", packed.substr(size / 2)) + pngChunk("IEND", "");
}

std::string zpng(std::size_t rows, std::size_t columns, std::size_t bytes,
                 const std::vector<std::uint32_t>& pixels) {
    std::string data(pixels.size() * bytes, '\0');
    std::uint32_t before = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (i % columns == 0) before = 0;
        std::array<int, 4> d{};
        for (std::size_t k = 0; k < 4; ++k)
            d[k] = static_cast<int>(pixels[i] >> 8 * k & 255U) -
                   static_cast<int>(before >> 8 * k & 255U);
        before = pixels[i];
        const std::size_t plane = pixels.size();
        if (bytes <= 2)
            for (std::size_t k = 0; k < bytes; ++k) data[bytes * i + k] = static_cast<char>(d[k]);
        else
            for (std::size_t k = 0; k < bytes; ++k)
                data[k * plane + i] = static_cast<char>(k == 0   ? d[2]
                                                        : k == 1 ? d[1] - d[2]
                                                        : k == 2 ? d[1] - d[0]
                                                                 : d[3]);
    }
    std::string packed(ZSTD_compressBound(data.size()), '\0');
    packed.resize(ZSTD_compress(packed.data(), packed.size(), data.data(), data.size(), 1));
    const bool isWide = bytes == 2;
    return raw<std::uint16_t>(0xFBF8) + raw(static_cast<std::uint16_t>(columns)) +
           raw(static_cast<std::uint16_t>(rows)) + static_cast<char>(isWide ? 1 : bytes) +
           static_cast<char>(isWide ? 2 : 1) + packed;
}

std::string block(const FlatTree& root) {
    const std::string bytes = flatBuffer(root);
    const auto sum = crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    return bytes + raw(static_cast<std::uint32_t>(sum));
}

std::string headerBlock(std::uint64_t metadataAt, std::uint64_t bytes) {
    FlatTree header;
    header.number<std::uint64_t>(0, 21)
        .number<std::uint8_t>(1, 2)
        .number(2, metadataAt)
        .number(3, bytes);
    return block(header);
}
}  // namespace

std::string flatBuffer(const FlatTree& root) {
    std::string out = raw(static_cast<std::uint32_t>(8 + placesOf(root))) + "OSF!";
    writeTable(out, root);
    return raw(static_cast<std::uint32_t>(out.size())) + out;
}

std::string codedField(FieldCoding coding, std::size_t rows, std::size_t columns, std::size_t bytes,
                       const std::vector<std::uint32_t>& pixels) {
    return coding == FieldCoding::kPng ? png(rows, columns, bytes, pixels)
                                       : zpng(rows, columns, bytes, pixels);
}

FlatTree osfTurn(const io::OusterInfo& info, const io::OusterFrame& frame, FieldCoding coding,
                 std::uint64_t received_ns) {
    std::vector<std::uint32_t> ranges(info.rows * info.columns), reflectivities(ranges.size()),
        statuses(info.columns);
    const auto columns = static_cast<int>(info.columns);
    for (std::size_t row = 0; row < info.rows; ++row)
        for (std::size_t column = 0; column < info.columns; ++column) {
            // PNGs hold rows that are shifted by so many columns.
            const int shift = coding == FieldCoding::kPng ? info.pixelShifts.at(row) : 0;
            const auto to =
                static_cast<std::size_t>((static_cast<int>(column) + shift + columns) % columns);
            const std::size_t from = column * info.rows + row;
            ranges[row * info.columns + to] = frame.ranges_mm[from];
            reflectivities[row * info.columns + to] = frame.reflectivities[from];
        }
    for (std::size_t column = 0; column < info.columns; ++column)
        statuses[column] = frame.received[column] ? 1 : 0;
    const auto image = [&](std::size_t bytes, const std::vector<std::uint32_t>& pixels) {
        return FlatTree().bytes(0, codedField(coding, info.rows, info.columns, bytes, pixels));
    };
    const auto number = static_cast<std::int32_t>(frame.number);
    FlatTree turn;
    turn.tables(0, {image(2, reflectivities), image(4, ranges), image(1, reflectivities)})
        .numbers<std::uint16_t>(1, {0x0203, 0x0301, 0x0105})  // signal, ranges, reflectivities
        .numbers(2, frame.times_ns)
        .numbers(4, statuses)
        .number(5, number)
        .numbers<std::uint64_t>(7, {0, received_ns});
    return turn;
}

std::string osfFile(const std::vector<OsfSensor>& sensors) {
    std::string chunks;
    std::size_t turns = 0;
    for (const OsfSensor& sensor : sensors) turns = std::max(turns, sensor.turns.size());
    for (std::size_t i = 0; i < turns; ++i)
        for (std::size_t s = 0; s < sensors.size(); ++s) {
            if (i >= sensors[s].turns.size()) continue;
            FlatTree message;
            message.number<std::uint64_t>(0, 1000 * i)
                .number(1, static_cast<std::uint32_t>(2 * s + 2))
                .bytes(2, flatBuffer(sensors[s].turns[i]));
            chunks += block(FlatTree().tables(0, {message}));
        }
    std::vector<FlatTree> entries;
    for (std::size_t s = 0; s < sensors.size(); ++s) {
        const auto id = static_cast<std::uint32_t>(2 * s + 1);
        entries.push_back(FlatTree()
                              .number(0, id)
                              .bytes(1, "ouster/v1/os_sensor/LidarSensor")
                              .bytes(2, flatBuffer(FlatTree().bytes(0, sensors[s].json))));
        entries.push_back(FlatTree()
                              .number(0, id + 1)
                              .bytes(1, "ouster/v1/os_sensor/LidarScanStream")
                              .bytes(2, flatBuffer(FlatTree().number(0, id))));
    }
    const std::string metadata = block(FlatTree().tables(4, entries));
    std::string header = headerBlock(0, 0);
    const std::uint64_t at = header.size() + chunks.size();
    header = headerBlock(at, at + metadata.size());
    header.replace(8, 4, "OSF$");
    // The name of the format is under the checksum.
    const auto sum = crc32_z(0, reinterpret_cast<const Bytef*>(header.data()), header.size() - 4);
    patch(header, header.size() - 4, static_cast<std::uint32_t>(sum));
    return header + chunks + metadata;
}
}  // namespace delio::test
