#include "delio/odometry/scan_to_map.h"

#include <tbb/parallel_invoke.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "delio/points/point_search.h"
#include "standstill.h"

namespace delio {
using planes::PlaneEstimate;
using points::PointEstimate;

namespace {
constexpr double kDeg = M_PI / 180;
}  // namespace

std::vector<OptionField> ScanToMapOptions::fields() const {
    using Me = ScanToMapOptions;
    return {{"point_sigma", &Me::point_sigma, "m; error of a scan placed by points along each axis",
             1e-6, 100},
            {"point_sigma_deg", &Me::point_sigma_deg,
             "deg; the same about each axis but the one that the sensor spins about", 1e-6, 180},
            {"believed", &Me::believed,
             "m; planes that lead farther than this from where points place the scan are not "
             "believed",
             0, 10},
            {"believed_deg", &Me::believed_deg, "deg; the same of the rotation", 0, 90},
            {"probe", &Me::probe,
             "m; points see an axis if they bring the scan back that was moved along it by this",
             0.05, 10}};
}

void ScanToMap::add(const Eigen::Matrix3Xf& points, const Eigen::Isometry3d& pose) {
    const Eigen::Matrix3Xd placed =
        (pose.linear() * points.cast<double>()).colwise() + pose.translation();
    // The one that splits up comes last: it is what a thread that has nothing else to do helps
    // with.
    tbb::parallel_invoke([&] { points_.add(placed); }, [&] { planes_.add(placed); });
    // Each sweep goes through all that is known: not with every scan.
    constexpr double kSweep_m = 10;
    if ((pose.translation() - swept_m_).norm() < kSweep_m) return;
    swept_m_ = pose.translation();
    tbb::parallel_invoke([&] { planes_.forgetFarFrom(swept_m_); },
                         [&] { points_.forgetFarFrom(swept_m_); });
}

void ScanToMap::erase(const Eigen::Matrix3Xf& points) {
    const Eigen::Matrix3Xd wanted = points.cast<double>();
    tbb::parallel_invoke([&] { planes_.erase(wanted); }, [&] { points_.erase(wanted); });
}

void ScanToMap::clear(const Eigen::Vector3d& up) {
    up_ = up;
    planes_.clear(up);
    points_.clear();
}

PointEstimate ScanToMap::place(const Eigen::Matrix3Xd& coarse, const Eigen::Isometry3d& predicted,
                               double kernel) const {
    return points::registerToPoints(points_, coarse, predicted, kernel, pointOptions_);
}

PointEstimate ScanToMap::placeAnywhere(const Eigen::Matrix3Xd& coarse,
                                       const Eigen::Isometry3d& predicted, double reach,
                                       const Eigen::Matrix3f& upright) const {
    return points::searchPoints(points_, coarse, predicted, reach, upright, pointOptions_);
}

PointEstimate ScanToMap::placeTurned(const Eigen::Matrix3Xd& coarse,
                                     const Eigen::Isometry3d& predicted, double enough) const {
    return points::searchTurns(points_, coarse, predicted, enough, pointOptions_);
}

/** Of the rotation that points found, rad^2, right tangent. A sensor's rings mislead about all axes
 *  but the one that it spins about, across which it sees least: about that one the points err as
 *  their distances say. */
Eigen::Matrix3d ScanToMap::turnCovariance(const Eigen::Matrix3Xd& points,
                                          const PointEstimate& placed) const {
    constexpr double kTogether = 5;  // neighbours err alike
    const Eigen::Matrix3Xd rays = points.colwise().normalized();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread(rays * rays.transpose());
    const Eigen::Vector3d axis = spread.eigenvectors().col(0);  // eigenvalues rise
    const double arms = (points.squaredNorm() - (axis.transpose() * points).squaredNorm()) /
                        static_cast<double>(points.cols()),
                 most = std::pow(options_.point_sigma_deg * kDeg, 2),
                 spin = std::pow(kTogether * std::max(placed.residual_m, options_.point_sigma), 2) /
                        (arms * static_cast<double>(placed.matches));
    return most * Eigen::Matrix3d::Identity() +
           (std::min(spin, most) - most) * axis * axis.transpose();
}

/** What the points say alone. */
PlaneEstimate ScanToMap::byPoints(const PointEstimate& placed,
                                  const Eigen::Matrix3d& turnCovariance) const {
    PlaneEstimate estimate;
    auto& rotation = estimate.rotation;
    auto& translation = estimate.translation;
    rotation.rotation = placed.pose.linear();
    rotation.covariance = turnCovariance;
    rotation.matches = translation.matches = placed.matches;
    rotation.iterations = placed.iterations;
    rotation.valid = translation.valid = estimate.valid = true;
    translation.translation = placed.pose.translation();
    translation.covariance = std::pow(options_.point_sigma, 2) * Eigen::Matrix3d::Identity();
    translation.residual_m = placed.residual_m;
    translation.unobservedAxes = Eigen::Matrix3d::Identity();
    estimate.share = placed.share;
    return estimate;
}

/** Static surfaces of a scan, fine enough that a motion by `probe` metres shows. */
surfaces::SurfaceNormals surfacesOf(const ScanView& view, double probe) {
    surfaces::NormalsOptions options;
    options.voxel_size = probe / 2;
    options.max_radius = 3 * probe;
    return surfaces::estimateNormals(view.fine, options);
}

/** For each axis that the planes do not constrain: where the points do not either, the prediction
 *  is taken and the axis is reported as unobserved. Where points say that the scan is where the
 *  latest one was, their answer stays; it is reported as unobserved unless surfaces that face the
 *  axis confirm the standstill. */
void ScanToMap::settleUnobserved(const ScanView& view, const Eigen::Isometry3d& predicted,
                                 const std::optional<Eigen::Isometry3d>& latest,
                                 PlaneEstimate& found) const {
    auto& translation = found.translation;
    if (translation.unobservedAxes.cols() == 0) return;
    const bool rests = latest && (translation.translation - latest->translation()).norm() <=
                                     pointOptions_.last_kernel;
    surfaces::SurfaceNormals surfaces;
    if (rests) surfaces = surfacesOf(view, options_.probe);
    const auto stands = [&](const Eigen::Vector3d& axis) {
        constexpr double kVertical = 0.8;  // cosine
        return showsStandstill(points_, surfaces, found.pose(),
                               {axis, std::abs(axis.dot(up_)) > kVertical, options_.probe,
                                pointOptions_.last_kernel / 2});
    };
    Eigen::Matrix3Xd unseen(3, 0);
    for (Eigen::Index i = 0; i < translation.unobservedAxes.cols(); ++i) {
        const Eigen::Vector3d axis = translation.unobservedAxes.col(i);
        const Eigen::Matrix3d along = axis * axis.transpose();
        if (!points::pointsSee(points_, view.coarse, found.pose(), axis, options_.probe,
                               pointOptions_))
            translation.translation += along * (predicted.translation() - translation.translation);
        else if (!rests || stands(axis))
            continue;
        translation.covariance += std::pow(planeOptions_.prior_sigma, 2) * along;
        unseen.conservativeResize(3, unseen.cols() + 1);
        unseen.rightCols<1>() = axis;
    }
    translation.unobservedAxes = unseen;
}

bool ScanToMap::believes(const PlaneEstimate& found, const PointEstimate& placed) const {
    const Eigen::Isometry3d off = placed.pose.inverse() * found.pose();
    return found.valid && off.translation().norm() <= options_.believed &&
           angleOf(off.linear()) <= options_.believed_deg * kDeg;
}

PlaneEstimate ScanToMap::refine(const ScanView& view, const PointEstimate& placed,
                                const Eigen::Isometry3d& predicted,
                                const std::optional<Eigen::Isometry3d>& latest) const {
    const auto byPlanes = [&](const PointEstimate& from) {
        const auto prior =
            planes::Prior::of(from.pose, options_.point_sigma, turnCovariance(view.coarse, from));
        return planes::registerToPlanes(planes_, view.thinned, prior, planeOptions_.last_kernel,
                                        planeOptions_);
    };
    PointEstimate from = placed;
    auto found = byPlanes(from);
    // The points were placed wrongly where more of them fit where planes lead.
    constexpr unsigned kPatience = 2;
    for (unsigned i = 0; i < kPatience && found.valid && !believes(found, from); ++i) {
        const auto there = place(view.coarse, found.pose(), pointOptions_.least_kernel);
        if (!there.valid || there.share <= from.share) break;
        from = there;
        found = byPlanes(from);
    }
    if (!believes(found, from)) found = byPoints(from, turnCovariance(view.coarse, from));
    found.rotation.unobservedAxes.resize(3, 0);  // points see every rotation
    settleUnobserved(view, predicted, latest, found);
    return found;
}
}  // namespace delio
