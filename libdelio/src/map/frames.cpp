#include "delio/map/frames.h"

#include <mrpt/math/TPose3D.h>
#include <mrpt/topography/conversions.h>

#include <ostream>

#include "delio/core/geometry.h"
#include "delio/core/numbers.h"
#include "delio/files/output_file.h"
#include "ground_plane.h"

namespace delio::map {
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {
constexpr double kDeg = M_PI / 180;

/** The rotation to a frame whose z is `up` and whose x is `forward` as far as it is level. */
Matrix3d levelled(const Vector3d& up, const Vector3d& forward) {
    const Vector3d x = (forward - forward.dot(up) * up).normalized();
    Matrix3d R;
    R.row(0) = x;
    R.row(1) = up.cross(x);
    R.row(2) = up;
    return R;
}

Vector3d groundNormal(const MapPoints& points, const Isometry3d& firstPose) {
    return planeOfGround(points, firstPose).normal();
}

std::string rowsOf(const Isometry3d& pose) {
    std::string text;
    for (int r = 0; r < 4; ++r) {
        text += r == 0 ? "\n  - [" : "  - [";
        for (int c = 0; c < 4; ++c)
            text += (c == 0 ? "" : ", ") + rounded(pose.matrix()(r, c) + 0.0, 17);  // no "-0"
        text += "]\n";
    }
    return text;
}
}  // namespace

Isometry3d groundFrame(const MapPoints& points, const Isometry3d& firstPose) {
    const auto plane = planeOfGround(points, firstPose);
    const Matrix3d R = levelled(plane.normal(), Vector3d::UnitX());
    const Vector3d first = firstPose.translation(), foot = plane.projection(first);
    return isometry(R, Vector3d(first.x(), first.y(), 0) - R * foot);
}

Isometry3d enuFrame(const MapPoints& points, const Isometry3d& firstPose, double heading_deg) {
    const Matrix3d level =
        levelled(groundNormal(points, firstPose), firstPose.linear() * Vector3d::UnitX());
    // A heading turns from north to east, an angle about up from east to north.
    const Matrix3d R = rotationExp((90 - heading_deg) * kDeg * Vector3d::UnitZ()) * level;
    return isometry(R, -(R * firstPose.translation()));
}

Isometry3d ecefFromEnu(const GeoReference& place) {
    const mrpt::topography::TGeodeticCoords coordinates(place.latitude_deg, place.longitude_deg,
                                                        place.altitude_m);
    mrpt::math::TPose3D axes;
    mrpt::topography::ENU_axes_from_WGS84(coordinates, axes);
    return fromMrpt(mrpt::poses::CPose3D(axes));
}

void saveFrame(const Isometry3d& otherFromMap, const std::optional<GeoReference>& place,
               const std::string& path) {
    io::replaceTextFile(path, [&](std::ostream& out) {
        out << "# p_out = transformation * p_map, metres\n"
            << "transformation:" << rowsOf(otherFromMap);
        if (!place) return;
        out << "# x east, y north, z up from here (WGS84)\n"
            << "origin:\n  latitude_deg: " << rounded(place->latitude_deg, 17)
            << "\n  longitude_deg: " << rounded(place->longitude_deg, 17)
            << "\n  altitude_m: " << rounded(place->altitude_m, 17)
            << "\nheading_deg: " << rounded(place->heading_deg, 17) << '\n'
            << "# p_ecef = ecef_from_enu * p_out\n"
            << "ecef_from_enu:" << rowsOf(ecefFromEnu(*place));
    });
}
}  // namespace delio::map
