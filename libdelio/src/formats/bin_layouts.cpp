#include "bin_layouts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "delio/core/error.h"

namespace delio::io {
namespace {
constexpr std::size_t kSample = 500;  // points of a scan that are looked at

Column real(const char* name) { return {name, 'F', 4}; }
Column whole(const char* name, std::size_t bytes) { return {name, 'U', bytes}; }

std::vector<BinLayout> makeLayouts() {
    const std::vector<Column> kitti{real("x"), real("y"), real("z"), real("intensity")};
    const auto with = [&](std::initializer_list<Column> more) {
        auto columns = kitti;
        columns.insert(columns.end(), more);
        return columns;
    };
    const std::vector<Column> aeva{real("x"),        real("y"),
                                   real("z"),        real("reflectivity"),
                                   real("velocity"), {"time_offset", 'I', 4},
                                   whole("_", 1)};
    auto lateAeva = aeva;
    lateAeva.push_back(real("intensity"));
    return {
        {"kitti", kitti},
        {"nuscenes", with({real("ring")})},
        {"boreas", with({real("ring"), real("time")})},
        {"nclt",
         {whole("x", 2), whole("y", 2), whole("z", 2), whole("intensity", 1), whole("ring", 1)}},
        {"mulran", kitti},
        {"helipr-ouster",
         with({whole("t", 4), whole("reflectivity", 2), whole("ring", 2), whole("ambient", 2)})},
        {"helipr-velodyne", with({whole("ring", 2), real("time")})},
        {"helipr-avia",
         {real("x"), real("y"), real("z"), whole("reflectivity", 1), whole("tag", 1),
          whole("line", 1), whole("offset_time", 4)}},
        {"helipr-aeva", aeva},
        {"helipr-aeva-intensity", lateAeva},
        {"pohang",
         with({whole("t", 4), whole("reflectivity", 2), whole("ambient", 2), whole("_", 4)})},
    };
}

template <typename Number>
double numberAt(const std::uint8_t* from) {
    Number number;
    std::memcpy(&number, from, sizeof(number));
    return static_cast<double>(number);
}

double valueAt(const Column& column, const std::uint8_t* from) {
    if (column.kind == 'F') return numberAt<float>(from);
    if (column.kind == 'I') return numberAt<std::int32_t>(from);
    return column.bytes == 1   ? numberAt<std::uint8_t>(from)
           : column.bytes == 2 ? numberAt<std::uint16_t>(from)
                               : numberAt<std::uint32_t>(from);
}

bool isPlausible(double value) {
    constexpr double kLeast = 1e-9, kMost = 1e7;
    const double size = std::abs(value);
    return value == 0 || std::isnan(value) || (size > kLeast && size < kMost);
}

bool isTime(const Column& column) {
    return column.name == "t" || column.name.find("time") != column.name.npos;
}
bool isRing(const Column& column) { return column.name == "ring" || column.name == "line"; }

/** Whether a value is one that this column can have. */
bool suits(const Column& column, double value) {
    constexpr double kMostRings = 256, kMostInAByte = 32, kTurn_s = 0.25, kMostSpeed = 200;
    if (isRing(column))
        return value >= 0 && value == std::floor(value) &&
               value < (column.bytes == 1 ? kMostInAByte : kMostRings);
    if (isTime(column)) return std::abs(value) <= (column.kind == 'F' ? kTurn_s : 1e9 * kTurn_s);
    if (column.name == "velocity") return std::isnan(value) || std::abs(value) < kMostSpeed;
    return column.kind != 'F' || isPlausible(value);
}

/** Rings and times that are all the same identify no layout. */
bool columnFits(const Column& column, std::size_t at, const std::vector<std::uint8_t>& bytes,
                std::size_t step) {
    constexpr double kEnough = 0.98;
    const std::size_t count = bytes.size() / step;
    std::size_t points = 0, good = 0;
    double least = INFINITY, most = -INFINITY;
    for (std::size_t i = 0; i < count; i += 1 + count / kSample, ++points) {
        const double value = valueAt(column, &bytes[i * step + at]);
        if (!suits(column, value)) continue;
        ++good;
        least = std::min(least, value);
        most = std::max(most, value);
    }
    const double least_good = (isRing(column) ? 1 : kEnough) * static_cast<double>(points);
    if (static_cast<double>(good) < least_good) return false;
    return !(isRing(column) || isTime(column)) || most > least;
}

bool fits(const BinLayout& layout, const std::vector<std::uint8_t>& bytes) {
    const std::size_t step = layout.step();
    if (bytes.empty() || bytes.size() % step != 0) return false;
    std::size_t at = 0;
    return std::all_of(layout.columns.begin(), layout.columns.end(), [&](const Column& column) {
        const bool good = columnFits(column, at, bytes, step);
        at += column.bytes;
        return good;
    });
}

bool isSpecific(const BinLayout& layout) {
    return std::any_of(layout.columns.begin(), layout.columns.end(),
                       [](const Column& column) { return isRing(column) || isTime(column); });
}

constexpr std::size_t kMulranRows = 64, kMulranColumns = 1024;
constexpr std::size_t kMulranBytes = kMulranRows * kMulranColumns * 16;

std::array<float, 3> mulranPoint(const std::vector<std::uint8_t>& bytes, std::size_t row,
                                 std::size_t column) {
    std::array<float, 3> xyz{};
    std::memcpy(xyz.data(), &bytes[(column * kMulranRows + row) * 16], sizeof(xyz));
    return xyz;
}

bool isReturn(const std::array<float, 3>& xyz) {
    constexpr float kNear = 0.1F;
    const float range = std::hypot(xyz[0], xyz[1], xyz[2]);
    return std::isfinite(range) && range > kNear;
}

struct MulranRow {
    double elevation = 0, spread = 0;  //!< mean and standard deviation, rad
    std::size_t returns = 0;
    std::size_t steps = 0, even = 0;  //!< between returns of neighbouring columns; of usual width
};

MulranRow mulranRow(const std::vector<std::uint8_t>& bytes, std::size_t row) {
    constexpr double kStep = 2 * M_PI / kMulranColumns;
    MulranRow found;
    double sum = 0, squares = 0;
    std::array<float, 3> before{};
    for (std::size_t column = 0; column < kMulranColumns; ++column) {
        const auto xyz = mulranPoint(bytes, row, column);
        if (isReturn(xyz)) {
            const double up = std::atan2(xyz[2], std::hypot(xyz[0], xyz[1]));
            sum += up;
            squares += up * up;
            ++found.returns;
            if (isReturn(before)) {
                const double turned = std::remainder(
                    std::atan2(xyz[1], xyz[0]) - std::atan2(before[1], before[0]), 2 * M_PI);
                ++found.steps;
                if (std::abs(std::abs(turned) - kStep) < kStep / 2) ++found.even;
            }
        }
        before = xyz;
    }
    if (found.returns == 0) return found;
    const auto count = static_cast<double>(found.returns);
    found.elevation = sum / count;
    found.spread = std::sqrt(std::max(0.0, squares / count - found.elevation * found.elevation));
    return found;
}
}  // namespace

const std::vector<BinLayout>& binLayouts() {
    static const std::vector<BinLayout> all = makeLayouts();
    return all;
}

std::string binLayoutNames() {
    std::string names;
    for (const BinLayout& layout : binLayouts())
        names += (names.empty() ? "" : ", ") + std::string(layout.name);
    return names;
}

const BinLayout& binLayoutNamed(const std::string& name) {
    for (const BinLayout& layout : binLayouts())
        if (layout.name == name) return layout;
    throw Error("there is no layout '" + name + "' of .bin files; the layouts are " +
                binLayoutNames());
}

bool beginWithFloats(const std::vector<std::uint8_t>& bytes, std::size_t step) {
    if (bytes.empty() || bytes.size() % step != 0) return false;
    const Column xyz = real("x");
    return columnFits(xyz, 0, bytes, step) && columnFits(xyz, 4, bytes, step) &&
           columnFits(xyz, 8, bytes, step);
}

std::vector<const BinLayout*> binLayoutsOf(const std::vector<std::uint8_t>& bytes) {
    std::vector<const BinLayout*> found;
    for (const BinLayout& layout : binLayouts())
        if (isSpecific(layout) && fits(layout, bytes)) found.push_back(&layout);
    if (!found.empty()) return found;
    if (beginWithFloats(bytes, 16))
        found.push_back(&binLayoutNamed(isMulran(bytes) ? "mulran" : "kitti"));
    return found;
}

CloudRecords recordsOfNclt(const std::vector<std::uint8_t>& bytes) {
    constexpr double kUnit_m = 0.005, kOrigin_m = -100;
    constexpr std::size_t kStep = 8, kNewStep = 14;
    CloudRecords records;
    records.count = bytes.size() / kStep;
    records.layout =
        layoutOf({real("x"), real("y"), real("z"), whole("intensity", 1), whole("ring", 1)});
    records.bytes.resize(records.count * kNewStep);
    for (std::size_t i = 0; i < records.count; ++i) {
        std::uint8_t* const to = &records.bytes[i * kNewStep];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double value =
                kOrigin_m + kUnit_m * numberAt<std::uint16_t>(&bytes[i * kStep + 2 * axis]);
            // x forward, y right, z down in the file.
            const auto turned = static_cast<float>(axis == 0 ? value : -value);
            std::memcpy(to + 4 * axis, &turned, sizeof(turned));
        }
        std::memcpy(to + 12, &bytes[i * kStep + 6], 2);
    }
    return records;
}

bool isMulran(const std::vector<std::uint8_t>& bytes) {
    constexpr double kSpread = 0.01, kEnough = 0.9;
    constexpr std::size_t kFewReturns = 32;
    if (bytes.size() != kMulranBytes) return false;
    std::size_t rows = 0, good = 0;
    double highest = INFINITY;
    for (std::size_t row = 0; row < kMulranRows; ++row) {
        const MulranRow found = mulranRow(bytes, row);
        if (found.returns < kFewReturns) continue;
        ++rows;
        // Upper rows come first.
        if (found.spread < kSpread &&
            found.elevation<highest&& static_cast<double>(found.even)> kEnough *
                static_cast<double>(found.steps))
            ++good;
        highest = found.elevation;
    }
    return rows >= kMulranRows / 4 &&
           static_cast<double>(good) > kEnough * static_cast<double>(rows);
}

CloudRecords recordsOfMulran(const std::vector<std::uint8_t>& bytes) {
    constexpr std::size_t kStep = 16, kNewStep = 20;
    constexpr double kTurn_s = 0.1;
    CloudRecords records;
    records.count = bytes.size() / kStep;
    if (bytes.size() != kMulranBytes) {  // a broken scan has no known columns
        records.layout = layoutOf(binLayoutNamed("kitti").columns);
        records.bytes = bytes;
        return records;
    }
    records.rows = kMulranColumns;
    records.layout = layoutOf({real("x"), real("y"), real("z"), real("intensity"), real("time")});
    records.bytes.resize(records.count * kNewStep);
    for (std::size_t i = 0; i < records.count; ++i) {
        std::memcpy(&records.bytes[i * kNewStep], &bytes[i * kStep], kStep);
        const auto time_s = static_cast<float>(kTurn_s * static_cast<double>(i / kMulranRows) /
                                               static_cast<double>(kMulranColumns));
        std::memcpy(&records.bytes[i * kNewStep + kStep], &time_s, sizeof(time_s));
    }
    return records;
}
}  // namespace delio::io
