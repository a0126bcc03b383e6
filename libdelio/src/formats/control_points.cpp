#include <cmath>
#include <map>
#include <ostream>

#include "delio/core/error.h"
#include "delio/core/text.h"
#include "delio/files/output.h"
#include "delio/formats/georeference.h"
#include "files/input_file.h"
#include "number_line.h"

namespace delio::io {
namespace {
/** A line of the file, by the names of its columns. */
class Row {
 public:
    Row(const std::map<std::string, std::size_t>& columns, std::vector<std::string> cells,
        std::string where)
        : columns_(columns), cells_(std::move(cells)), where_(std::move(where)) {}

    std::string text(const std::string& column) const {
        const auto found = columns_.find(column);
        return found != columns_.end() && found->second < cells_.size() ? cells_[found->second]
                                                                        : "";
    }
    double number(const std::string& column) const {
        const auto value = numberIn<double>(text(column));
        if (!value || !std::isfinite(*value))
            throw Error(where_ + ": " + column + " is missing or not a number");
        return *value;
    }
    earth::UtmZone zone() const {
        const std::string name = text("zone");
        const char side = name.empty() ? ' ' : name.back();
        const auto number = numberIn<int>(name.substr(0, name.size() - (name.empty() ? 0 : 1)));
        if (!number || *number < 1 || *number > 60 || (side != 'N' && side != 'S'))
            throw Error(where_ + ": zone must be one like 32N or 56S");
        return {*number, side == 'N'};
    }
    bool isUsed(bool byDefault) const {
        if (columns_.count("use") == 0) return byDefault;
        const std::string use = text("use");
        if (use != "0" && use != "1") throw Error(where_ + ": use must be 0 or 1");
        return use == "1";
    }
    earth::Geodetic place() const {
        const bool isUtm = columns_.count("easting") > 0;
        const auto there =
            isUtm ? earth::geodeticOfUtm({number("easting"), number("northing"), number("height")},
                                         zone())
                  : earth::Geodetic{number("latitude"), number("longitude"), number("height")};
        if (!earth::isPlausible(there)) throw Error(where_ + ": the place is not on the earth");
        return there;
    }

 private:
    const std::map<std::string, std::size_t>& columns_;
    std::vector<std::string> cells_;
    std::string where_;
};

std::map<std::string, std::size_t> columnsIn(const std::vector<std::string>& names,
                                             const std::string& where) {
    std::map<std::string, std::size_t> columns;
    for (std::size_t i = 0; i < names.size(); ++i) columns.emplace(lowerCase(names[i]), i);
    const auto has = [&](const char* name) { return columns.count(name) > 0; };
    const bool isPlaced =
        (has("latitude") && has("longitude")) || (has("easting") && has("northing") && has("zone"));
    if (!has("x") || !has("y") || !has("z") || !has("height") || !isPlaced)
        throw Error(where +
                    ": the header must name x, y, z, height, and latitude, longitude or "
                    "easting, northing, zone");
    return columns;
}
}  // namespace

std::vector<earth::ControlPoint> readControlPoints(const std::string& path, bool areUsed) {
    const auto bytes = bytesOfFile(path);
    std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    std::vector<earth::ControlPoint> points;
    std::map<std::string, std::size_t> columns;
    std::size_t number = 0;
    while (const auto line = nextLine(rest, &number)) {
        if (line->front() == '#') continue;
        const std::string where = "'" + path + "', line " + std::to_string(number);
        if (columns.empty()) {
            columns = columnsIn(cellsIn(*line), where);
            continue;
        }
        const Row row(columns, cellsIn(*line), where);
        const std::string name = row.text("name");
        points.push_back({name.empty() ? std::to_string(points.size() + 1) : name,
                          {row.number("x"), row.number("y"), row.number("z")},
                          row.place(),
                          row.isUsed(areUsed)});
    }
    if (points.empty()) throw Error("'" + path + "' contains no control points");
    return points;
}

void writeControlErrors(const std::vector<earth::ControlPoint>& points,
                        const earth::Georeference& place, const std::string& path) {
    replaceTextFile(path, [&](std::ostream& out) {
        out << "name,used,east_error_m,north_error_m,up_error_m\n";
        for (const auto& point : points) {
            // Tenths of a millimetre, and no "-0".
            const Eigen::Vector3d error = (errorOf(point, place) * 1e4).array().round() / 1e4 + 0.0;
            out << point.name << ',' << point.isUsed << ',' << fixed(error.x(), 4) << ','
                << fixed(error.y(), 4) << ',' << fixed(error.z(), 4) << '\n';
        }
    });
}
}  // namespace delio::io
