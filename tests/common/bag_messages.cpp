#include <cmath>
#include <cstring>

#include "bag_writers.h"

namespace delio::test {
WireWriter::WireWriter(Kind kind) : kind_(kind) {
    if (kind == Kind::kCdr) bytes_.assign("\0\1\0\0", 4);
    if (kind == Kind::kCdrBigEndian) bytes_.assign(4, '\0');
}

WireWriter& WireWriter::raw(std::uint64_t value, std::size_t size) {
    if (kind_ != Kind::kRos1) bytes_.resize(4 + (bytes_.size() - 4 + size - 1) / size * size);
    for (std::size_t i = 0; i < size; ++i) {
        const std::size_t place = kind_ == Kind::kCdrBigEndian ? size - 1 - i : i;
        bytes_ += static_cast<char>(value >> (8 * place) & 0xffU);
    }
    return *this;
}

WireWriter& WireWriter::bytes(const BagBytes& value) {
    bytes_ += value;
    return *this;
}

WireWriter& WireWriter::byteArray(const BagBytes& value) {
    return number(static_cast<std::uint32_t>(value.size())).bytes(value);
}

WireWriter& WireWriter::text(const std::string& value) {
    return byteArray(kind_ == Kind::kRos1 ? value : value + '\0');
}

WireWriter& WireWriter::time(double seconds) {
    const double whole = std::floor(seconds);
    number(static_cast<std::uint32_t>(whole));
    return number(static_cast<std::uint32_t>(std::lround(1e9 * (seconds - whole))));
}

WireWriter& WireWriter::header(double stamp_s, const std::string& frame) {
    if (kind_ == Kind::kRos1) number(std::uint32_t{7});
    return time(stamp_s).text(frame);
}

namespace {
constexpr std::uint32_t kStep = 24;  // two bytes of it are not used

template <typename Number>
void put(BagBytes& record, std::size_t offset, Number value, bool bigEndian) {
    char bytes[sizeof(Number)];
    std::memcpy(bytes, &value, sizeof(Number));
    for (std::size_t i = 0; i < sizeof(Number); ++i)
        record[offset + i] = bytes[bigEndian ? sizeof(Number) - 1 - i : i];
}

BagBytes pointsOf(const CloudSpec& spec) {
    BagBytes data;
    for (std::uint32_t row = 0; row < spec.rows; ++row) {
        for (std::uint32_t column = 0; column < spec.columns; ++column) {
            const std::uint32_t i = row * spec.columns + column;
            BagBytes record(kStep, '\0');
            const float told[] = {static_cast<float>(10 + spec.scan), static_cast<float>(i), -1.5F,
                                  0.5F};
            const float* point = spec.xyzi ? &spec.xyzi->at(4 * i) : told;
            for (std::uint32_t k = 0; k < 4; ++k) put(record, 4 * k, point[k], spec.bigEndian);
            put(record, 16, static_cast<std::uint16_t>(i % 16), spec.bigEndian);
            put(record, 18, 0.001F * static_cast<float>(i % 100), spec.bigEndian);
            data += record;
        }
        data.append(spec.padding, '\x7f');
    }
    return data;
}
}  // namespace

WireWriter& WireWriter::real(double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof(bits));
    return number(bits);
}

BagBytes transformsMessage(const std::vector<std::pair<std::string, Eigen::Vector3d>>& frames,
                           WireWriter::Kind kind) {
    WireWriter out(kind);
    out.number(static_cast<std::uint32_t>(frames.size()));
    for (const auto& [name, place] : frames) {
        out.header(0, "base").text(name);
        for (const double value : place) out.real(value);
        for (const double value : {0.0, 0.0, std::sqrt(0.5), std::sqrt(0.5)}) out.real(value);
    }
    return out.message();
}

BagBytes cloudMessage(const CloudSpec& spec, WireWriter::Kind kind) {
    struct Field {
        const char* name;
        std::uint32_t offset;
        std::uint8_t kind;
    };
    const Field fields[] = {{spec.withX ? "x" : "ex", 0, 7},
                            {"y", 4, 7},
                            {"z", 8, 7},
                            {"intensity", 12, 7},
                            {"ring", 16, 4},
                            {"time", 18, 7}};
    WireWriter out(kind);
    out.header(spec.stamp_s, spec.frame).number(spec.rows).number(spec.columns);
    const std::uint32_t count = spec.xyzi ? 4 : 6;
    out.number(count);
    for (const Field& field : fields)
        if (&field - fields < count)
            out.text(field.name).number(field.offset).number(field.kind).number(std::uint32_t{1});
    out.number(static_cast<std::uint8_t>(spec.bigEndian)).number(kStep);
    out.number(kStep * spec.columns + spec.padding);
    return out.byteArray(pointsOf(spec)).number(std::uint8_t{1}).message();
}
}  // namespace delio::test
