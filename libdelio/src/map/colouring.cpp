#include "delio/map/colouring.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "delio/core/error.h"
#include "ground_height.h"

namespace delio::map {
namespace {
/** A way of colouring that takes one of a point's values. */
struct Value {
    ColourBy by;
    const char *option, *name, *unit;
    float (*of)(const MapPoint&);
};

/** Height and normals are not one of a point's values: they have a name only. */
const std::array<Value, 6> kValues{{
    {ColourBy::Height, "height", "height above ground", " m", nullptr},
    {ColourBy::Intensity, "intensity", "intensity", "",
     [](const MapPoint& p) { return p.intensity; }},
    {ColourBy::Time, "time", "time", " s", [](const MapPoint& p) { return p.time_s; }},
    {ColourBy::Normal, "normal", "normal", "", nullptr},
    {ColourBy::Residual, "residual", "residual", " m",
     [](const MapPoint& p) { return p.residual_m; }},
    {ColourBy::Observations, "observations", "observations", "",
     [](const MapPoint& p) { return static_cast<float>(p.observations); }},
}};

mrpt::img::TColor colourOfNormal(const Eigen::Vector3f& normal) {
    const auto byte = [](float v) {
        return static_cast<std::uint8_t>(std::lround(127.5F * (std::clamp(v, -1.0F, 1.0F) + 1)));
    };
    return {byte(normal.x()), byte(normal.y()), byte(normal.z())};
}

std::vector<float> valuesOf(const MapPoints& points, const Value& value) {
    if (!value.of)
        return heightsAboveGround(points.size(), [&](std::size_t i) { return points[i].position; });
    std::vector<float> values;
    values.reserve(points.size());
    for (const auto& point : points) values.push_back(value.of(point));
    return values;
}

/** What is not known is 0 (map_point.h). */
bool isKnown(const MapPoints& points, const Value& value) {
    if (points.empty() || value.by == ColourBy::Height) return true;
    return std::any_of(points.begin(), points.end(), [&](const MapPoint& point) {
        return value.of ? value.of(point) != 0 : !point.normal.isZero();
    });
}
}  // namespace

std::vector<std::string> colourByNames() {
    std::vector<std::string> names;
    names.reserve(kValues.size());
    for (const auto& value : kValues) names.emplace_back(value.option);
    return names;
}

ColourBy colourByNamed(const std::string& name) {
    std::string known;
    for (const auto& value : kValues) {
        if (name == value.option) return value.by;
        known += (known.empty() ? "" : ", ") + std::string(value.option);
    }
    throw Error("points cannot be coloured by '" + name + "'; choose one of " + known);
}

Colours coloursOf(const MapPoints& points, const Colouring& colouring) {
    const Value& value = *std::find_if(kValues.begin(), kValues.end(),
                                       [&](const Value& v) { return v.by == colouring.by; });
    if (!isKnown(points, value))
        throw Error("the map's points have no " + std::string(value.option) + " to be coloured by");
    Colours colours{{}, value.name, value.unit, {}};
    colours.ofPoints.reserve(points.size());
    if (colouring.by == ColourBy::Normal) {
        for (const auto& point : points) colours.ofPoints.push_back(colourOfNormal(point.normal));
        return colours;
    }
    const auto values = valuesOf(points, value);
    colours.range = robustRange(values);
    for (const float v : values)
        colours.ofPoints.push_back(
            colourAt(colouring.colormap, colours.range->fractionAt(double{v})));
    return colours;
}
}  // namespace delio::map
