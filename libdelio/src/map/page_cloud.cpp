#include "map/page_cloud.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <tuple>

namespace delio::map {
namespace {
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "a page has numbers as the machine does");

// Beyond it lies no map, and a float has no millimetres.
constexpr float kWorld_m = 1e7F;

bool isSomewhere(const MapPoint& point) {
    return (point.position.array().abs() < kWorld_m).all();  // so that NaN is nowhere
}

struct Placed {
    std::array<std::int32_t, 3> tile;
    std::uint32_t turn;  // of its tile, when it is drawn
    std::uint32_t point;
};

bool operator<(const Placed& a, const Placed& b) {
    return std::tie(a.tile, a.turn, a.point) < std::tie(b.tile, b.turn, b.point);
}

/** `value` in steps from `low`, as far as the type reaches. */
template <typename Unsigned>
Unsigned steps(double value, double low, double step) {
    constexpr double kMost = std::numeric_limits<Unsigned>::max();
    if (!(step > 0) || !std::isfinite(value)) return 0;
    return static_cast<Unsigned>(std::lround(std::clamp((value - low) / step, 0.0, kMost)));
}

std::vector<Placed> placed(const MapPoints& points) {
    std::vector<Placed> result(points.size());
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            result[i].tile[axis] = static_cast<std::int32_t>(std::floor(
                double{points[i].position[static_cast<int>(axis)]} / PageCloud::kTile_m));
        result[i].turn = i * 2654435769U;  // 2^32 by the golden ratio: evenly over the points
        result[i].point = i;
    }
    std::sort(result.begin(), result.end());
    return result;
}

template <typename Value>
ValueRange wholeRange(const MapPoints& points, const Value& value) {
    ValueRange range{0, 0};
    bool first = true;
    for (const auto& point : points) {
        const double v = value(point);
        if (!std::isfinite(v)) continue;
        range =
            first ? ValueRange{v, v} : ValueRange{std::min(range.low, v), std::max(range.high, v)};
        first = false;
    }
    return range;
}
}  // namespace

PageScales pageScalesOf(const MapPoints& points) {
    std::vector<float> intensities;
    intensities.reserve(points.size());
    for (const auto& point : points) intensities.push_back(point.intensity);
    return {robustRange(std::move(intensities)),
            wholeRange(points, [](const MapPoint& point) { return double{point.time_s}; })};
}

MapPoints thinned(const MapPoints& points, std::size_t most) {
    std::vector<std::size_t> whole;
    whole.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        if (isSomewhere(points[i])) whole.push_back(i);
    const std::size_t kept = std::min(most, whole.size());
    MapPoints result;
    result.reserve(kept);
    for (std::size_t i = 0; i < kept; ++i) result.push_back(points[whole[i * whole.size() / kept]]);
    return result;
}

PageCloud pageCloudOf(const MapPoints& points, const PageScales& scales,
                      const GroundHeight& ground) {
    PageCloud cloud;
    cloud.places.reserve(4 * points.size());
    cloud.known.reserve(4 * points.size());
    const auto order = placed(points);
    const double intensityStep = (scales.intensity.high - scales.intensity.low) / 255;
    const double timeStep = (scales.time_s.high - scales.time_s.low) / 65535;
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i == 0 || order[i].tile != order[i - 1].tile) {
            const auto& tile = order[i].tile;
            cloud.tiles.push_back({{tile[0] * PageCloud::kTile_m, tile[1] * PageCloud::kTile_m,
                                    tile[2] * PageCloud::kTile_m},
                                   i,
                                   0});
        }
        auto& tile = cloud.tiles.back();
        ++tile.count;
        const auto& point = points[order[i].point];
        const Eigen::Vector3d place = point.position.cast<double>();
        for (int axis = 0; axis < 3; ++axis)
            cloud.places.push_back(steps<std::uint16_t>(
                place[axis], tile.origin_m[static_cast<std::size_t>(axis)], PageCloud::kQuantum_m));
        cloud.places.push_back(steps<std::uint16_t>(place.z() - ground.at(place.x(), place.y()),
                                                    PageCloud::kLowestGround_m,
                                                    PageCloud::kGroundQuantum_m));
        const auto time = steps<std::uint16_t>(double{point.time_s}, scales.time_s.low, timeStep);
        cloud.known.push_back(
            steps<std::uint8_t>(double{point.intensity}, scales.intensity.low, intensityStep));
        cloud.known.push_back(static_cast<std::uint8_t>(std::min<int>(point.observations, 255)));
        cloud.known.push_back(static_cast<std::uint8_t>(time & 0xff));
        cloud.known.push_back(static_cast<std::uint8_t>(time >> 8));
    }
    return cloud;
}

void writeBase64(const std::uint8_t* bytes, std::size_t count, std::ostream& out) {
    constexpr const char* kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string line;
    for (std::size_t i = 0; i < count; i += 3) {
        const std::size_t here = std::min<std::size_t>(3, count - i);
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (k < here ? bytes[i + k] : std::uint32_t{0});
        for (std::size_t k = 0; k < 4; ++k)
            line += k <= here ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
        if (line.size() < kBase64Line && i + 3 < count) continue;
        out << line << '\n';
        line.clear();
    }
}
}  // namespace delio::map
