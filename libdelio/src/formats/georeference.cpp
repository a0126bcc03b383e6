#include "delio/formats/georeference.h"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <ostream>

#include "delio/core/error.h"
#include "delio/core/text.h"
#include "delio/files/output.h"

namespace delio::io {
namespace {
template <typename Matrix>
void writeRows(std::ostream& out, const char* name, const Matrix& m) {
    out << name << ":\n";
    for (Eigen::Index r = 0; r < m.rows(); ++r) {
        out << "  - [";
        for (Eigen::Index c = 0; c < m.cols(); ++c)
            out << (c == 0 ? "" : ", ") << rounded(m(r, c) + 0.0, 17);  // no "-0"
        out << "]\n";
    }
}

double numberOf(const YAML::Node& node) {
    const auto number = numberIn<double>(node.as<std::string>());
    if (!number || !std::isfinite(*number)) throw Error("a value is not a finite number");
    return *number;
}

template <typename Matrix>
void readRows(const YAML::Node& node, Matrix& m) {
    if (node.size() != static_cast<std::size_t>(m.rows())) throw Error("a matrix is incomplete");
    for (Eigen::Index r = 0; r < m.rows(); ++r)
        for (Eigen::Index c = 0; c < m.cols(); ++c)
            m(r, c) = numberOf(node[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)]);
}

std::string degrees(double value) { return fixed(value, 9); }
std::string metres(double value) { return fixed(value, 4); }
}  // namespace

void writeGeoreference(const earth::Georeference& place, const earth::GnssFigures& figures,
                       const std::string& path) {
    const auto zone = earth::utmZoneOf(place.origin);
    const auto utm = earth::utmOf(place.origin, zone);
    replaceTextFile(path, [&](std::ostream& out) {
        out << "# WGS84; x east, y north, z up from here\n"
            << "origin:\n  latitude_deg: " << rounded(place.origin.latitude_deg, 17)
            << "\n  longitude_deg: " << rounded(place.origin.longitude_deg, 17)
            << "\n  altitude_m: " << rounded(place.origin.height_m, 17)
            << "\n# p_enu = enu_from_map * p_map, metres\n";
        writeRows(out, "enu_from_map", place.enuFromMap.matrix());
        out << "# of enu_from_map, in the map's frame: x y z (m) and rotation (rad)\n";
        writeRows(out, "covariance", place.covariance);
        out << "crs: EPSG:" << zone.epsg() << "\nutm_zone: " << zone.name() << "\nutm_origin: ["
            << metres(utm.x()) << ", " << metres(utm.y()) << ", " << metres(utm.z())
            << "]\nheading_deg: " << rounded(figures.heading_deg, 9)
            << "\nheading_sigma_deg: " << rounded(figures.headingSigma_deg, 6)
            << "\nfixes: " << figures.fixes << "\nfixes_used: " << figures.used
            << "\nfixes_rejected: " << figures.rejected << "\nrms_m: " << rounded(figures.rms_m, 6)
            << "\nrms_up_m: " << rounded(figures.rmsUp_m, 6) << '\n';
    });
}

earth::Georeference readGeoreference(const std::string& path) {
    try {
        const YAML::Node node = YAML::LoadFile(path);
        earth::Georeference place;
        place.origin = {numberOf(node["origin"]["latitude_deg"]),
                        numberOf(node["origin"]["longitude_deg"]),
                        numberOf(node["origin"]["altitude_m"])};
        Eigen::Matrix4d transformation;
        readRows(node["enu_from_map"], transformation);
        const Eigen::Matrix3d R = transformation.topLeftCorner<3, 3>();
        if (!earth::isPlausible(place.origin) || !(R * R.transpose()).isIdentity(1e-6) ||
            R.determinant() < 0)
            throw Error("the transformation is not a rigid one, or the origin is not on the earth");
        place.enuFromMap.matrix() = transformation;
        readRows(node["covariance"], place.covariance);
        return place;
    } catch (const std::exception& e) {
        throw Error("cannot parse '" + path + "': " + plainMessage(e));
    }
}

void writeGeoTrajectory(const Trajectory& trajectory, const earth::Georeference& place,
                        const std::string& path) {
    const earth::EnuFrame frame(place.origin);
    const auto zone = earth::utmZoneOf(place.origin);
    replaceTextFile(path, [&](std::ostream& out) {
        out << (trajectory.stamps_s.empty() ? "" : "stamp_s,")
            << "latitude,longitude,height,east,north,up,utm_easting,utm_northing,heading_deg\n";
        for (std::size_t i = 0; i < trajectory.poses.size(); ++i) {
            const Eigen::Isometry3d pose = place.enuFromMap * trajectory.poses[i];
            const Eigen::Vector3d enu = pose.translation();
            const auto geodetic = frame.geodeticOf(enu);
            const auto utm = earth::utmOf(geodetic, zone);
            if (!trajectory.stamps_s.empty()) out << rounded(trajectory.stamps_s[i], 17) << ',';
            out << degrees(geodetic.latitude_deg) << ',' << degrees(geodetic.longitude_deg) << ','
                << metres(geodetic.height_m) << ',' << metres(enu.x()) << ',' << metres(enu.y())
                << ',' << metres(enu.z()) << ',' << metres(utm.x()) << ',' << metres(utm.y()) << ','
                << fixed(earth::heading_deg(pose), 4) << '\n';
        }
    });
}

void writeGeoJson(const Trajectory& trajectory, const earth::Georeference& place,
                  const std::string& name, const std::string& path) {
    constexpr double kStep_m = 1;
    const earth::EnuFrame frame(place.origin);
    std::string title;
    for (const char c : name)
        if (c != '"' && c != '\\' && static_cast<unsigned char>(c) >= ' ') title += c;
    replaceTextFile(path, [&](std::ostream& out) {
        out << "{\"type\":\"Feature\",\"properties\":{\"name\":\"" << title
            << "\"},\"geometry\":{\"type\":\"LineString\",\"coordinates\":[";
        Eigen::Vector3d last = Eigen::Vector3d::Zero();
        for (std::size_t i = 0; i < trajectory.poses.size(); ++i) {
            const Eigen::Vector3d enu = place.enuFromMap * trajectory.poses[i].translation();
            const bool isEnd = i == 0 || i + 1 == trajectory.poses.size();
            if (!isEnd && (enu - last).norm() < kStep_m) continue;
            last = enu;
            const auto at = frame.geodeticOf(enu);
            out << (i == 0 ? "" : ",") << '[' << degrees(at.longitude_deg) << ','
                << degrees(at.latitude_deg) << ',' << fixed(at.height_m, 3) << ']';
        }
        out << "]}}\n";
    });
}
}  // namespace delio::io
