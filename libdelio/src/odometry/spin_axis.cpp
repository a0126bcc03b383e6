#include "odometry/spin_axis.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/kd_tree.h"
#include "core/voxel_grid.h"
#include "odometry/ground_plane.h"

namespace delio::odometry {
namespace {
/** Of many rays those in some cells of directions, anywhere: what was next to each other is, and
 *  few of them say what all do. */
Eigen::Matrix3Xf partOf(const Eigen::Matrix3Xf& rays) {
    constexpr Eigen::Index kEnough = 16000;
    constexpr double kCell = 0.1;  // rad, about
    if (rays.cols() <= kEnough) return rays;
    constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15;  // spreads neighbours
    const double share = static_cast<double>(kEnough) / static_cast<double>(rays.cols());
    const auto most = static_cast<std::uint64_t>(std::ldexp(share, 64));
    Eigen::Matrix3Xf part(3, rays.cols());
    Eigen::Index kept = 0;
    for (Eigen::Index i = 0; i < rays.cols(); ++i)
        if (voxelKey(rays.col(i).cast<double>(), kCell) * kGolden < most)
            part.col(kept++) = rays.col(i);
    return part.leftCols(kept);
}

/** Directions from rays to the two next to them, which are enough: unit vectors. */
std::vector<Eigen::Vector3d> stepsToNeighbours(const Eigen::Matrix3Xf& rays) {
    constexpr Eigen::Index kAsked = 3000;
    constexpr float kSame = 1e-5F, kFar = 0.05F;  // rad
    constexpr std::size_t kLeaf = 100;
    const KdTree tree(rays, kLeaf);
    std::vector<Eigen::Vector3d> steps;
    for (Eigen::Index i = 0; i < rays.cols();
         i += std::max<Eigen::Index>(1, rays.cols() / kAsked)) {
        std::array<std::uint32_t, 3> indices{};
        std::array<float, 3> squared{};
        const auto found = tree.nearest(rays.col(i), 3, indices.data(), squared.data());
        for (std::size_t k = 0; k < found; ++k) {
            const Eigen::Vector3f step = rays.col(indices[k]) - rays.col(i);
            const float length = step.norm();
            if (length > kSame && length < kFar) steps.emplace_back((step / length).cast<double>());
        }
    }
    return steps;
}
}  // namespace

std::optional<Eigen::Vector3d> spinAxisOf(const Eigen::Matrix3Xf& points) {
    constexpr std::size_t kLeast = 300;
    constexpr double kFirst = 0.5, kLast = 0.02, kAcross = 0.05, kShare = 0.7;
    const auto steps = stepsToNeighbours(partOf(points.colwise().normalized()));
    if (steps.size() < kLeast) return {};
    Eigen::Vector3d axis = Eigen::Vector3d::Zero();  // at first all steps count alike
    for (double width = kFirst;; width /= 2) {
        Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
        for (const auto& step : steps) {
            const double robust = 1 / (1 + std::pow(step.dot(axis) / width, 2));
            sum += robust * robust * step * step.transpose();
        }
        axis = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sum).eigenvectors().col(0);
        if (width < kLast) break;
    }
    const auto across = std::count_if(steps.begin(), steps.end(), [&](const auto& step) {
        return std::abs(step.dot(axis)) < kAcross;
    });
    if (static_cast<double>(across) < kShare * static_cast<double>(steps.size())) return {};
    return axis;
}

namespace {
/** A point's time, seconds, and azimuth about the axis, rad. */
using Azimuths = std::vector<std::pair<double, double>>;

/** In the order of time, of some points. */
Azimuths azimuthsOf(const Eigen::Matrix3Xf& points, const std::vector<float>& times_s,
                    const Eigen::Vector3d& axis) {
    constexpr Eigen::Index kEnough = 5000;
    const Eigen::Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
    Azimuths all;
    for (Eigen::Index i = 0; i < points.cols();
         i += std::max<Eigen::Index>(1, points.cols() / kEnough)) {
        const Eigen::Vector3d point = points.col(i).cast<double>();
        all.emplace_back(double{times_s[static_cast<std::size_t>(i)]},
                         std::atan2(point.dot(v), point.dot(u)));
    }
    std::sort(all.begin(), all.end());
    return all;
}
}  // namespace

std::optional<double> turnPeriodOf(const Eigen::Matrix3Xf& points,
                                   const std::vector<float>& times_s) {
    constexpr double kShare = 0.8, kAlike = 0.1, kPart = 0.25;
    if (points.cols() == 0) return {};
    const Eigen::Vector3d axis = spinAxisOf(points).value_or(Eigen::Vector3d::UnitZ());
    const Azimuths all = azimuthsOf(points, times_s, axis);
    const double apart_s = kPart * (all.back().first - all.front().first);
    if (!(apart_s > 0)) return {};
    std::vector<double> rates;  // turns a second
    for (std::size_t i = 0, j = 0; i < all.size(); ++i) {
        while (j < all.size() && all[j].first < all[i].first + apart_s) ++j;
        if (j == all.size()) break;
        const double turned = all[j].second - all[i].second;
        rates.push_back(std::remainder(turned, 2 * M_PI) / (2 * M_PI) /
                        (all[j].first - all[i].first));
    }
    if (rates.empty()) return {};
    const auto middle = rates.begin() + static_cast<std::ptrdiff_t>(rates.size() / 2);
    std::nth_element(rates.begin(), middle, rates.end());
    const double rate = *middle;
    const auto alike = std::count_if(rates.begin(), rates.end(), [&](double other) {
        return std::abs(other - rate) < kAlike * std::abs(rate);
    });
    if (rate == 0 || static_cast<double>(alike) < kShare * static_cast<double>(rates.size()))
        return {};
    return 1 / std::abs(rate);
}

Eigen::Matrix3f turnedUp(const Eigen::Vector3d& up) {
    constexpr double kNearly = 2 * M_PI / 180;
    const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
    if (up.z() > 0 && up.cross(z).norm() < std::sin(kNearly)) return Eigen::Matrix3f::Identity();
    return Eigen::Quaterniond::FromTwoVectors(up, z).toRotationMatrix().cast<float>();
}

std::optional<Eigen::Matrix3f> uprightOf(const Eigen::Matrix3Xf& points) {
    constexpr double kLying = 0.5;
    const auto axis = spinAxisOf(points);
    if (!axis) return {};
    const Eigen::VectorXf along = axis->cast<float>().transpose() * points;
    const bool isUp = std::abs(axis->z()) > kLying
                          ? axis->z() > 0
                          : 2 * (along.array() < 0).count() > along.size();  // ground is below
    return turnedUp(isUp ? *axis : -*axis);
}

Eigen::Matrix3f uprightOf(const Eigen::Isometry3d& sensorPose, const Eigen::Matrix3Xf& points) {
    Eigen::Matrix3f mounted = turnedUp(sensorPose.linear().row(2));
    if (!mounted.isIdentity()) return mounted;
    const Eigen::Matrix3f spinning = uprightOf(points).value_or(mounted);
    const auto ground = groundNormalOf(points, spinning.row(2).transpose().cast<double>());
    return ground ? turnedUp(*ground) : spinning;
}

Eigen::Vector3d upIn(const Eigen::Isometry3d& sensorPose, const Eigen::Matrix3Xf& points) {
    return sensorPose.linear() * uprightOf(sensorPose, points).row(2).transpose().cast<double>();
}
}  // namespace delio::odometry
