#include "control_points.h"

#include <algorithm>
#include <cmath>

#include "delio/core/error.h"
#include "delio/core/text.h"

namespace delio {
namespace {
bool isUsed(const earth::ControlPoint& point) { return point.isUsed; }

/** "4 used, RMS 0.012 m horizontally, 0.020 m in height"; empty without such points. */
std::string errorsOf(const std::vector<earth::ControlPoint>& points,
                     const earth::Georeference& place, bool used) {
    double squared = 0, squaredUp = 0;
    std::size_t count = 0;
    for (const auto& point : points) {
        if (point.isUsed != used) continue;
        const Eigen::Vector3d error = errorOf(point, place);
        squared += error.head<2>().squaredNorm();
        squaredUp += error.z() * error.z();
        ++count;
    }
    if (count == 0) return "";
    const auto rms = [&](double sum) {
        return fixed(std::sqrt(sum / static_cast<double>(count)), 3);
    };
    return std::to_string(count) + (used ? " used" : " checked") + ", RMS " + rms(squared) +
           " m horizontally, " + rms(squaredUp) + " m in height";
}
}  // namespace

std::string controlFileOf(const std::string& output) { return output + ".control.csv"; }

std::vector<earth::ControlPoint> placeByControl(const std::string& file,
                                                std::optional<earth::Georeference>& place) {
    auto points = io::readControlPoints(file, !place);
    if (std::any_of(points.begin(), points.end(), isUsed))
        place = earth::georeferenceOf(points);
    else if (!place)
        throw Error("'" + file + "': no point is used, and the map is not georeferenced");
    return points;
}

std::string summaryOf(const std::vector<earth::ControlPoint>& points,
                      const earth::Georeference& place) {
    const std::string used = errorsOf(points, place, true),
                      checked = errorsOf(points, place, false);
    return "control points: " + used + (used.empty() || checked.empty() ? "" : "; ") + checked;
}
}  // namespace delio
