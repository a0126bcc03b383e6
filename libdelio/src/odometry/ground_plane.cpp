#include "odometry/ground_plane.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "core/principal_axes.h"
#include "core/voxel_grid.h"

namespace delio::odometry {
namespace {
constexpr float kRadius_m = 25;
constexpr float kThick_m = 0.15F;  // of the ground
constexpr float kBelow_m = 0.4F;   // deeper, a point is not of the ground
constexpr float kLowest_m = 0.2F;  // height of a sensor above the ground

struct Plane3 {
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    float height = 0;  //!< of the sensor above it, metres
};

/** One point of each half metre, so that a ring counts by its length. */
Eigen::Matrix3Xf surroundings(const Eigen::Matrix3Xf& points) {
    constexpr double kVoxel_m = 0.5;
    Eigen::Matrix3Xf near(3, points.cols());
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        if (points.col(i).squaredNorm() < kRadius_m * kRadius_m) near.col(count++) = points.col(i);
    return firstOfVoxels(near.leftCols(count), kVoxel_m);
}

Eigen::ArrayXf heightsOver(const Plane3& plane, const Eigen::Matrix3Xf& points) {
    return (plane.normal.transpose() * points).array() + plane.height;
}

/** How many points lie on it; those below it, which ground has not, count against it. */
double supportOf(const Plane3& plane, const Eigen::Matrix3Xf& points) {
    constexpr double kAgainst = 3;
    const Eigen::ArrayXf heights = heightsOver(plane, points);
    const auto on = (heights.abs() < kThick_m).count(), below = (heights < -kBelow_m).count();
    return static_cast<double>(on) - kAgainst * static_cast<double>(below);
}

/** Of the points that lie on it, by least squares. */
Plane3 fitted(const Plane3& plane, const Eigen::Matrix3Xf& points) {
    const Eigen::ArrayXf heights = heightsOver(plane, points);
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        if (std::abs(heights[i]) >= kThick_m) continue;
        const Eigen::Vector3d point = points.col(i).cast<double>();
        sum += point;
        squares += point * point.transpose();
        ++count;
    }
    if (count < 3) return plane;
    const Eigen::Vector3d mean = sum / count;
    Eigen::Vector3d normal = principalAxes(squares / count - mean * mean.transpose()).axes.col(0);
    if (normal.dot(plane.normal.cast<double>()) < 0) normal = -normal;
    return {normal.cast<float>(), static_cast<float>(-normal.dot(mean))};
}

/** The largest planes below the sensor: how many points lie on the one across `up`, and on another
 *  one, which counts the less the more it is tilted. */
struct Candidates {
    Plane3 tilted;
    double ofTilted = 0, across = 0;
};

Candidates candidatesIn(const Eigen::Matrix3Xf& points, const Eigen::Vector3f& up) {
    constexpr int kTries = 2000;
    constexpr float kAcross = 0.985F, kSteepest = 0.42F;  // cosines: 10 and 65 deg
    Candidates best;
    std::mt19937 random(1);
    const auto draw = [&] {
        const auto count = static_cast<std::uint32_t>(points.cols());
        return Eigen::Vector3f(points.col(static_cast<Eigen::Index>(random() % count)));
    };
    for (int i = 0; i < kTries; ++i) {
        const Eigen::Vector3f a = draw(), b = draw(), c = draw();
        Eigen::Vector3f normal = (b - a).cross(c - a).normalized();
        if (normal.dot(up) < 0) normal = -normal;
        const Plane3 plane{normal, -normal.dot(a)};
        const float along = normal.dot(up);
        if (!(plane.height > kLowest_m) || !(along > kSteepest)) continue;
        const double support = supportOf(plane, points);
        if (along > kAcross) {
            best.across = std::max(best.across, support);
        } else if (const double share = double{along} * support; share > best.ofTilted) {
            best.ofTilted = share;
            best.tilted = plane;
        }
    }
    return best;
}
}  // namespace

std::optional<Eigen::Vector3d> groundNormalOf(const Eigen::Matrix3Xf& points,
                                              const Eigen::Vector3d& up) {
    constexpr double kFewest = 50, kShare = 0.1, kClearly = 2;
    const Eigen::Matrix3Xf near = surroundings(points);
    const double least = std::max(kFewest, kShare * static_cast<double>(near.cols()));
    if (static_cast<double>(near.cols()) < least) return {};
    const Candidates found = candidatesIn(near, up.cast<float>());
    if (found.ofTilted < std::max(least, kClearly * found.across)) return {};
    return fitted(found.tilted, near).normal.cast<double>();
}
}  // namespace delio::odometry
