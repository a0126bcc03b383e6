#include "ground_plane.h"

#include <Eigen/Eigenvalues>
#include <random>
#include <vector>

#include "delio/core/error.h"

namespace delio::map {
using Eigen::Isometry3d;
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

/** Whether the ground may lie so; turns its normal upwards. */
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
}  // namespace

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
        throw Error("there is no ground within " + std::to_string(static_cast<int>(kReach_m)) +
                    " m of the map's first pose that it could be levelled by");
    return {Vector3d(vehicle.linear() * plane.normal()),
            Vector3d(vehicle * Vector3d(-plane.offset() * plane.normal()))};
}
}  // namespace delio::map
