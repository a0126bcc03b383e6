#include "delio/map/colouring.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "delio/core/error.h"
#include "map/ground.h"

namespace delio::map {
namespace {
using Polynomial = std::array<double, 6>;

double evaluate(const Polynomial& c, double t) {
    return c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * c[5]))));
}

mrpt::img::TColor fromUnit(double r, double g, double b) {
    const auto byte = [](double v) {
        return static_cast<std::uint8_t>(std::lround(255 * std::clamp(v, 0.0, 1.0)));
    };
    return {byte(r), byte(g), byte(b)};
}

// The published fifth-order approximation of Turbo (A. Mikhailov, Google, Apache 2.0).
mrpt::img::TColor turbo(double t) {
    return fromUnit(
        evaluate({0.13572138, 4.61539260, -42.66032258, 132.13108234, -152.94239396, 59.28637943},
                 t),
        evaluate({0.09140261, 2.19418839, 4.84296658, -14.18503333, 4.27729857, 2.82956604}, t),
        evaluate({0.10667330, 12.64194608, -60.58204836, 110.36276771, -89.90310912, 27.34824973},
                 t));
}

// Matplotlib's Viridis (CC0) at steps of 1/8; straight lines between.
mrpt::img::TColor viridis(double t) {
    constexpr double table[9][3] = {{68, 1, 84},    {71, 44, 122},  {59, 81, 139},
                                    {44, 113, 142}, {33, 144, 141}, {39, 173, 129},
                                    {92, 200, 99},  {170, 220, 50}, {253, 231, 37}};
    const auto below = std::min<std::size_t>(static_cast<std::size_t>(t * 8), 7);
    const double f = t * 8 - static_cast<double>(below);
    const auto channel = [&](std::size_t i) {
        return ((1 - f) * table[below][i] + f * table[below + 1][i]) / 255;
    };
    return fromUnit(channel(0), channel(1), channel(2));
}

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

/** Unknown values are 0 (map_point.h). */
bool isKnown(const MapPoints& points, const Value& value) {
    if (points.empty() || value.by == ColourBy::Height) return true;
    return std::any_of(points.begin(), points.end(), [&](const MapPoint& point) {
        return value.of ? value.of(point) != 0 : !point.normal.isZero();
    });
}
}  // namespace

std::vector<std::string> colormapNames() { return {"turbo", "viridis", "gray"}; }

Colormap colormapNamed(const std::string& name) {
    if (name == "turbo") return Colormap::Turbo;
    if (name == "viridis") return Colormap::Viridis;
    if (name == "gray") return Colormap::Gray;
    throw Error("unknown colour map '" + name + "'; choose turbo, viridis or gray");
}

mrpt::img::TColor colourAt(Colormap colormap, double t) {
    t = std::isfinite(t) ? std::clamp(t, 0.0, 1.0) : 0.0;
    switch (colormap) {
        case Colormap::Turbo:
            // Without its nearly black ends, which vanish on a dark background.
            return turbo(0.08 + 0.87 * t);
        case Colormap::Viridis:
            return viridis(t);
        case Colormap::Gray:
            break;
    }
    // Not from black: that would vanish on a dark background.
    return fromUnit(0.2 + 0.8 * t, 0.2 + 0.8 * t, 0.2 + 0.8 * t);
}

ValueRange robustRange(std::vector<float> values) {
    values.erase(
        std::remove_if(values.begin(), values.end(), [](float v) { return !std::isfinite(v); }),
        values.end());
    if (values.empty()) return {};
    const auto percentile = [&](std::size_t percent) {
        const auto at =
            values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * percent / 100);
        std::nth_element(values.begin(), at, values.end());
        return double{*at};
    };
    ValueRange range{percentile(2), percentile(98)};
    if (range.high - range.low < 1e-3) {
        range.low -= 5e-4;
        range.high += 5e-4;
    }
    return range;
}

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
    throw Error("cannot colour points by '" + name + "'; choose one of " + known);
}

Colours coloursOf(const MapPoints& points, const Colouring& colouring) {
    const Value& value = *std::find_if(kValues.begin(), kValues.end(),
                                       [&](const Value& v) { return v.by == colouring.by; });
    if (!isKnown(points, value))
        throw Error("the map's points have no " + std::string(value.option) + " to colour by");
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
