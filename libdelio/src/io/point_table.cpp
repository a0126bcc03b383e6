#include "point_table.h"

#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <initializer_list>

#include "delio/core/error.h"
#include "drive_clock.h"

namespace delio::io {
namespace {
using Names = std::initializer_list<const char*>;
const Names kIntensities = {"intensity",    "intensities", "i",
                            "reflectivity", "reflectance", "signal"};
const Names kRings = {"ring", "channel", "line", "laser_id", "row"};
const Names kTimes = {"time",       "t",           "timestamp",   "time_stamp",
                      "timestamps", "offset_time", "time_offset", "point_time_offset",
                      "offset",     "stamp",       "timeoffset",  "relative_time"};

const PointField* find(const PointLayout& layout, const Names& names) {
    for (const char* name : names)
        for (const auto& field : layout.fields)
            if (field.name == name) return &field;
    return nullptr;
}

const PointField& coordinate(const PointLayout& layout, const char* name) {
    const PointField* field = find(layout, {name});
    if (field) return *field;
    std::string there;
    for (const auto& other : layout.fields) there += (there.empty() ? "" : ", ") + other.name;
    throw Error(std::string("its points have no field '") + name + "' (they have: " + there + ")");
}

void check(const PointLayout& layout, std::size_t bytes, std::size_t count) {
    for (const auto& field : layout.fields) {
        const std::size_t size = bytesOf(field.kind);
        if (size == 0)
            throw Error("its field '" + field.name + "' is of kind " +
                        std::to_string(static_cast<int>(field.kind)) + ", which is not known");
        if (layout.step < size || field.offset > layout.step - size)
            throw Error("its field '" + field.name + "' does not lie within a point of " +
                        std::to_string(layout.step) + " bytes");
    }
    if (layout.step == 0 || count > bytes / layout.step)
        throw Error("it claims " + std::to_string(count) + " points of " +
                    std::to_string(layout.step) + " bytes, but has " + std::to_string(bytes) +
                    " bytes");
}

template <typename Raw, bool kSwapped>
Raw rawAt(const std::uint8_t* from) {
    std::uint8_t swapped[sizeof(Raw)];
    if (kSwapped) {
        std::reverse_copy(from, from + sizeof(Raw), swapped);
        from = swapped;
    }
    Raw raw;
    std::memcpy(&raw, from, sizeof(Raw));
    return raw;
}

/** The numbers of one field, of all points. */
class Values {
 public:
    Values(const PointLayout& layout, const std::uint8_t* data, std::size_t count)
        : layout_(layout), data_(data), count_(count) {}

    template <typename Number>
    std::vector<Number> of(const PointField& field) const {
        switch (field.kind) {
            case NumberKind::kInt8:
                return as<std::int8_t, Number>(field);
            case NumberKind::kUint8:
                return as<std::uint8_t, Number>(field);
            case NumberKind::kInt16:
                return as<std::int16_t, Number>(field);
            case NumberKind::kUint16:
                return as<std::uint16_t, Number>(field);
            case NumberKind::kInt32:
                return as<std::int32_t, Number>(field);
            case NumberKind::kUint32:
                return as<std::uint32_t, Number>(field);
            case NumberKind::kFloat32:
                return as<float, Number>(field);
            case NumberKind::kFloat64:
                return as<double, Number>(field);
        }
        return {};
    }

 private:
    template <typename Raw, typename Number>
    std::vector<Number> as(const PointField& field) const {
        return layout_.bigEndian ? as<Raw, Number, true>(field) : as<Raw, Number, false>(field);
    }
    template <typename Raw, typename Number, bool kSwapped>
    std::vector<Number> as(const PointField& field) const {
        std::vector<Number> values(count_);
        for (std::size_t i = 0; i < count_; ++i)  // no pointer is made to where nothing lies
            values[i] =
                static_cast<Number>(rawAt<Raw, kSwapped>(data_ + i * layout_.step + field.offset));
        return values;
    }

    const PointLayout& layout_;
    const std::uint8_t* data_;
    std::size_t count_;
};

/** Whole numbers up to 255 or 65535 are brought to 0 to 1, as the other readers have it. */
float fullScale(NumberKind kind) {
    if (kind == NumberKind::kUint8) return 255;
    if (kind == NumberKind::kUint16) return 65535;
    return 1;
}

mrpt::maps::CPointsMap::Ptr cloudOf(const PointLayout& layout, const Values& values,
                                    std::size_t count) {
    const auto x = values.of<float>(coordinate(layout, "x"));
    const auto y = values.of<float>(coordinate(layout, "y"));
    const auto z = values.of<float>(coordinate(layout, "z"));
    const PointField* bright = find(layout, kIntensities);
    mrpt::maps::CPointsMap::Ptr cloud;
    if (!bright) {
        cloud = mrpt::maps::CSimplePointsMap::Create();
        cloud->setAllPoints(x, y, z);
        return cloud;
    }
    auto withIntensity = mrpt::maps::CPointsMapXYZI::Create();
    withIntensity->resize(count);
    const auto intensities = values.of<float>(*bright);
    const float full = fullScale(bright->kind);
    for (std::size_t i = 0; i < count; ++i) {
        withIntensity->setPointFast(i, x[i], y[i], z[i]);
        withIntensity->setPointIntensity(i, intensities[i] / full);
    }
    withIntensity->mark_as_modified();
    return withIntensity;
}

/** A number outside of the type's range has no whole number: no ring. */
std::vector<std::uint16_t> ringsOf(const std::vector<double>& raw) {
    std::vector<std::uint16_t> rings;
    for (const double ring : raw) {
        if (!(ring >= 0 && ring <= 1023)) return {};
        rings.push_back(static_cast<std::uint16_t>(ring));
    }
    return rings;
}

std::vector<std::uint16_t> rowsOf(std::size_t count, std::size_t rows) {
    constexpr std::size_t kFewest = 2, kMost = 256;
    if (rows < kFewest || rows > kMost || count % rows != 0 || count / rows < rows) return {};
    std::vector<std::uint16_t> rings(count);
    for (std::size_t i = 0; i < count; ++i)
        rings[i] = static_cast<std::uint16_t>(i / (count / rows));
    return rings;
}
}  // namespace

std::size_t bytesOf(NumberKind kind) {
    switch (kind) {
        case NumberKind::kInt8:
        case NumberKind::kUint8:
            return 1;
        case NumberKind::kInt16:
        case NumberKind::kUint16:
            return 2;
        case NumberKind::kInt32:
        case NumberKind::kUint32:
        case NumberKind::kFloat32:
            return 4;
        case NumberKind::kFloat64:
            return 8;
    }
    return 0;
}

Scan PointTable::scan(const PointLayout& layout, const std::uint8_t* data, std::size_t bytes,
                      std::size_t count, std::size_t rows, double stamp_s) {
    check(layout, bytes, count);
    const Values values(layout, data, count);
    Scan scan;
    scan.stamp_s = stamp_s;
    scan.time = timeOf(stamp_s);
    scan.points = cloudOf(layout, values, count);
    if (const PointField* ring = find(layout, kRings))
        scan.rings = ringsOf(values.of<double>(*ring));
    else
        scan.rings = rowsOf(count, rows);
    if (const PointField* time = find(layout, kTimes))
        setTimes(values.of<double>(*time), stamp_s, scan);
    return scan;
}

void PointTable::setTimes(const std::vector<double>& raw, double stamp_s, Scan& scan) {
    double first = INFINITY, last = -INFINITY;
    for (const double time : raw)
        if (std::isfinite(time)) {
            first = std::min(first, time);
            last = std::max(last, time);
        }
    if (!(last > first)) return;
    if (!clock_) {
        constexpr std::size_t kEnough = 8;  // points, of which some are of another part of a turn
        if (raw.size() < kEnough) return;
        Clock clock;
        // A turn takes from 1 ms to 1 s: one unit fits.
        while (clock.unit_s > 1e-9 && (last - first) * clock.unit_s >= 1) clock.unit_s *= 1e-3;
        constexpr double kNear_s = 2;
        if (std::abs(first * clock.unit_s - stamp_s) < kNear_s && stamp_s > kNear_s)
            clock.zero = Clock::Zero::kUnix;
        else if (std::max(std::abs(first), std::abs(last)) * clock.unit_s >= 1)
            clock.zero = Clock::Zero::kFirstPoint;
        clock_ = clock;
    }
    double zero = 0;
    if (clock_->zero == Clock::Zero::kFirstPoint) zero = first;
    if (clock_->zero == Clock::Zero::kUnix) zero = stamp_s / clock_->unit_s;
    scan.times_s.reserve(raw.size());
    for (const double time : raw) {
        // What was not measured has no time, nor coordinates that would need one.
        const double time_s = std::isfinite(time) ? (time - zero) * clock_->unit_s : 0;
        if (!(std::abs(time_s) <= 1)) {  // a clock that was set: it tells nothing
            scan.times_s.clear();
            return;
        }
        scan.times_s.push_back(static_cast<float>(time_s));
    }
}
}  // namespace delio::io
