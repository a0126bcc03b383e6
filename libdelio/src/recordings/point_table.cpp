#include "point_table.h"

#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <initializer_list>

#include "delio/core/error.h"
#include "mrpt/clock.h"

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
            throw Error("its field '" + field.name + "' has the unknown type " +
                        std::to_string(static_cast<int>(field.kind)));
        if (layout.step < size || field.offset > layout.step - size)
            throw Error("its field '" + field.name + "' lies outside the point of " +
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

/** Rows of an organised cloud, or its columns where there are fewer of them. */
std::vector<std::uint16_t> rowsOf(std::size_t count, std::size_t rows) {
    constexpr std::size_t kFewest = 2, kMost = 256;
    if (rows < kFewest || count == 0 || count % rows != 0) return {};
    const std::size_t columns = count / rows, beams = std::min(rows, columns);
    if (beams < kFewest || beams > kMost) return {};
    std::vector<std::uint16_t> rings(count);
    for (std::size_t i = 0; i < count; ++i)
        rings[i] = static_cast<std::uint16_t>(rows <= columns ? i / columns : i % columns);
    return rings;
}
/** A point at the origin is how many drivers write that there was no return. */
std::vector<bool> measuredOf(const mrpt::maps::CPointsMap& cloud) {
    const auto& x = cloud.getPointsBufferRef_x();
    const auto& y = cloud.getPointsBufferRef_y();
    const auto& z = cloud.getPointsBufferRef_z();
    std::vector<bool> isMeasured(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        const bool isFinite = std::isfinite(x[i]) && std::isfinite(y[i]) && std::isfinite(z[i]);
        isMeasured[i] = isFinite && (x[i] != 0 || y[i] != 0 || z[i] != 0);
    }
    return isMeasured;
}

std::optional<RecordedTimes> timesIn(const PointLayout& layout, const Values& values,
                                     const Scan& scan) {
    const PointField* time = find(layout, kTimes);
    if (!time) return {};
    return RecordedTimes{values.of<double>(*time), measuredOf(*scan.points),
                         time->kind == NumberKind::kUint32, scan.stamp_s, scan.index};
}
}  // namespace

bool isLivox(const PointLayout& layout) { return find(layout, {"tag"}) && find(layout, {"line"}); }

bool hasTimes(const PointLayout& layout) { return find(layout, kTimes) != nullptr; }

Scan PointTable::scan(const PointLayout& layout, const std::uint8_t* data, std::size_t bytes,
                      std::size_t count, std::size_t rows, const ScanPlace& place) {
    check(layout, bytes, count);
    const Values values(layout, data, count);
    Scan scan;
    scan.index = place.index;
    scan.stamp_s = place.stamp_s;
    scan.time = timeOf(place.stamp_s);
    scan.points = cloudOf(layout, values, count);
    const PointField* const ring = find(layout, kRings);
    if (isLivox(layout))
        scan.rings.clear();
    else if (ring)
        scan.rings = ringsOf(values.of<double>(*ring));
    else
        scan.rings = rowsOf(count, rows);
    if (auto times = timesIn(layout, values, scan))
        scan.times_s = clock_.secondsOf(std::move(*times));
    return scan;
}

bool PointTable::look(const PointLayout& layout, const std::uint8_t* data, std::size_t bytes,
                      std::size_t count, double stamp_s) {
    check(layout, bytes, count);
    const Values values(layout, data, count);
    Scan scan;
    scan.stamp_s = stamp_s;
    scan.points = cloudOf(layout, values, count);
    auto times = timesIn(layout, values, scan);
    return !times || clock_.look(std::move(*times));
}
}  // namespace delio::io
