#include "delio/map/frames.h"

#include <mrpt/math/TPose3D.h>
#include <mrpt/topography/conversions.h>

#include <Eigen/Eigenvalues>
#include <ostream>
#include <random>
#include <vector>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/core/text.h"
#include "delio/files/output.h"

namespace delio::map {
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Plane = Eigen::Hyperplane<double, 3>;
using Points = std::vector<Vector3d>;

namespace {
constexpr double kReach_m = 10;
constexpr double kMaxTilt_deg = 30;
constexpr double kHighest_m = 0.5, kLowest_m = -5;  // of the ground, in the vehicle's frame
constexpr double kThickness_m = 0.1;                // to either side
constexpr std::size_t kFewest = 30;
constexpr double kLeastShare = 0.05;    // of the points around that lie on the ground
constexpr double kLeastSpread_m = 0.5;  // standard deviation, across its narrower side
constexpr std::size_t kSample = 4000;
constexpr int kTries = 1000;

/** In the vehicle's frame. */
Points pointsAround(const MapPoints& points, const Isometry3d& vehicle) {
    const Isometry3d vehicleFromMap = vehicle.inverse();
    Points around;
    for (const auto& point : points) {
        const Vector3d p = vehicleFromMap * point.position.cast<double>();
        if (p.norm() < kReach_m) around.push_back(p);
    }
    return around;
}

/** True if the plane can be the ground; orients its normal upwards. */
bool mayBeGround(Plane& plane) {
    if (plane.normal().z() < 0) plane.coeffs() *= -1;
    if (!(plane.normal().z() > std::cos(kMaxTilt_deg * M_PI / 180))) return false;
    const double height = -plane.offset() / plane.normal().z();  // below the vehicle's origin
    return height > kLowest_m && height < kHighest_m;
}

Points pointsOn(const Plane& plane, const Points& points) {
    Points on;
    for (const auto& p : points)
        if (plane.absDistance(p) < kThickness_m) on.push_back(p);
    return on;
}

/** The plane through three of the points that most of them lie on; the seed is fixed. */
bool findPlane(const Points& points, Plane& best) {
    Points sample;
    const std::size_t step = points.size() / kSample + 1;
    for (std::size_t i = 0; i < points.size(); i += step) sample.push_back(points[i]);
    std::mt19937 random(1);
    std::size_t most = 0;
    for (int i = 0; i < kTries; ++i) {
        const auto any = [&] { return sample[random() % sample.size()]; };
        const Vector3d a = any(), b = any(), c = any();
        const Vector3d normal = (b - a).cross(c - a);
        if (normal.norm() < 1e-2) continue;
        Plane plane(normal.normalized(), a);
        if (!mayBeGround(plane)) continue;
        const std::size_t on = pointsOn(plane, sample).size();
        if (on > most) {
            most = on;
            best = plane;
        }
    }
    return most >= 3;
}

/** The plane of least squares; false where the points do not span one. */
bool fit(const Points& points, Plane& plane) {
    Vector3d mean = Vector3d::Zero();
    for (const auto& p : points) mean += p / static_cast<double>(points.size());
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const auto& p : points)
        spread += (p - mean) * (p - mean).transpose() / static_cast<double>(points.size());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
    plane = Plane(Vector3d(solver.eigenvectors().col(0)), mean);
    return solver.eigenvalues()[1] > kLeastSpread_m * kLeastSpread_m && mayBeGround(plane);
}

constexpr double kDeg = M_PI / 180;

/** The ground plane around a vehicle, with its normal upwards, in the map's frame. Throws Error if
 *  no ground is found. */
Plane planeOfGround(const MapPoints& points, const Isometry3d& vehicle) {
    const Points around = pointsAround(points, vehicle);
    Plane plane;
    bool found = around.size() >= kFewest && findPlane(around, plane);
    for (int i = 0; found && i < 5; ++i) {
        const Points on = pointsOn(plane, around);
        found = on.size() >= kFewest &&
                static_cast<double>(on.size()) > kLeastShare * static_cast<double>(around.size()) &&
                fit(on, plane);
    }
    if (!found)
        throw Error("no ground found within " + std::to_string(static_cast<int>(kReach_m)) +
                    " m of the map's first pose to level the map");
    return {Vector3d(vehicle.linear() * plane.normal()),
            Vector3d(vehicle * Vector3d(-plane.offset() * plane.normal()))};
}

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

void saveUtmFrame(const earth::Georeference& place, const std::string& path) {
    const earth::MapToUtm utm(place);
    io::replaceTextFile(path, [&](std::ostream& out) {
        out << "# easting, northing, height (above the WGS84 ellipsoid) = p_out + offset, metres\n"
            << "crs: EPSG:" << utm.zone().epsg() << "\nutm_zone: " << utm.zone().name()
            << "\noffset: [" << fixed(utm.offset().x(), 0) << ", " << fixed(utm.offset().y(), 0)
            << ", 0]\n"
            << "# p_enu = enu_from_map * p_map, metres; x east, y north, z up from here (WGS84)\n"
            << "origin:\n  latitude_deg: " << rounded(place.origin.latitude_deg, 17)
            << "\n  longitude_deg: " << rounded(place.origin.longitude_deg, 17)
            << "\n  altitude_m: " << rounded(place.origin.height_m, 17)
            << "\nenu_from_map:" << rowsOf(place.enuFromMap);
    });
}
}  // namespace delio::map
