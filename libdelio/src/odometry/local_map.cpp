#include "odometry/local_map.h"

#include <tbb/parallel_invoke.h>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "odometry/search_points.h"

namespace delio::odometry {
namespace {
/** Surfaces that face an axis: what they say about a motion along it. */
struct Facing {
    Eigen::Matrix3Xd points, normals;  //!< map's frame
    bool isAllAround = false;          //!< not to one side of the sensor only
};

Facing facing(const paper::SurfaceNormals& scan, const Eigen::Isometry3d& pose,
              const Eigen::Vector3d& axis, bool isVertical) {
    constexpr double kFacing = 0.5;    // cosine: within 60 deg
    constexpr float kGrazing = 0.3F;   // cosine between normal and ray
    constexpr double kOneSided = 0.8;  // length of the mean direction: 1 for a single direction
    const Eigen::Index all = scan.directions.cols();
    Facing found{Eigen::Matrix3Xd(3, all), Eigen::Matrix3Xd(3, all)};
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();
    Eigen::Index kept = 0;
    for (Eigen::Index i = 0; i < all; ++i) {
        const Eigen::Vector3d normal = pose.linear() * scan.directions.col(i).cast<double>(),
                              point = scan.points.col(i).cast<double>();
        if (std::abs(normal.dot(axis)) < kFacing) continue;
        // The noise of the ranges makes a ring on a floor look like a surface along its rays.
        const float across = scan.directions.col(i).dot(scan.points.col(i).normalized());
        if (!isVertical && std::abs(across) < kGrazing) continue;
        found.normals.col(kept) = normal;
        found.points.col(kept++) = pose * point;
        direction += point.normalized();
    }
    found.normals.conservativeResize(3, kept);
    found.points.conservativeResize(3, kept);
    found.isAllAround = direction.norm() < kOneSided * static_cast<double>(kept);
    return found;
}

/** How the surfaces, moved by `offset`, lie on the map. */
struct Fit {
    double ratio = 0;    //!< of them within reach, 0 to 1
    double shift_m = 0;  //!< along the axis that brings them onto the map's points, least squares
};

Fit fitOf(const PointMap& map, const Facing& surfaces, const Eigen::Vector3d& axis,
          const Eigen::Vector3d& offset, double reach) {
    double near = 0, weights = 0, moments = 0;
    const Eigen::Matrix3Xd points = surfaces.points.colwise() + offset;
    const auto found = map.nearestOf(points, reach);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const auto& nearest = found[static_cast<std::size_t>(i)];
        if (!nearest.any) continue;
        const Eigen::Vector3d point = points.col(i), normal = surfaces.normals.col(i);
        const double along = normal.dot(axis);
        ++near;
        weights += along * along;
        moments += along * normal.dot(nearest.point - point);
    }
    return {near / static_cast<double>(surfaces.points.cols()),
            weights > 0 ? moments / weights : 0};
}
}  // namespace

bool showsStandstill(const PointMap& map, const paper::SurfaceNormals& scan,
                     const Eigen::Isometry3d& pose, const StandstillTest& test) {
    // Where a single far ring turns from the ground to a wall, it looks like a surface across the
    // road: in a smooth corridor up to 1 % of all surfaces.
    constexpr double kFewest = 20, kFewestOfAll = 0.02;
    constexpr double kMatched = 0.5, kGone = 0.5, kStill_m = 0.02;
    const Facing surfaces = facing(scan, pose, test.axis, test.isVertical);
    const auto count = static_cast<double>(surfaces.points.cols()),
               all = static_cast<double>(scan.directions.cols());
    if (count < std::max(kFewest, kFewestOfAll * all) || !(surfaces.isAllAround || test.isVertical))
        return false;
    const auto fitAt = [&](double along_m) {
        return fitOf(map, surfaces, test.axis, along_m * test.axis, test.reach);
    };
    const Fit here = fitAt(0);
    const double elsewhere = std::max(fitAt(test.probe).ratio, fitAt(-test.probe).ratio);
    return here.ratio >= kMatched && elsewhere <= kGone * here.ratio &&
           std::abs(here.shift_m) <= kStill_m;
}

namespace {
constexpr double kDeg = M_PI / 180;
}  // namespace

void LocalMap::add(const Eigen::Matrix3Xf& points, const Eigen::Isometry3d& pose) {
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

void LocalMap::addScan(const Eigen::Matrix3Xf& points, const Eigen::Isometry3d& pose) {
    constexpr std::size_t kMemory = 100;
    const double apart = pointOptions_.last_kernel / 2;
    add(points, pose);
    if (!origins_.empty() && (origins_.back() - pose.translation()).norm() < apart) return;
    origins_.push_back(pose.translation());
    if (origins_.size() > kMemory) origins_.pop_front();
}

bool LocalMap::isWhereAScanWas(const Eigen::Vector3d& place) const {
    return std::any_of(origins_.begin(), origins_.end(), [&](const Eigen::Vector3d& origin) {
        return (place - origin).norm() <= pointOptions_.last_kernel;
    });
}

void LocalMap::erase(const Eigen::Matrix3Xf& points) {
    const Eigen::Matrix3Xd wanted = points.cast<double>();
    tbb::parallel_invoke([&] { planes_.erase(wanted); }, [&] { points_.erase(wanted); });
}

void LocalMap::clear(const Eigen::Vector3d& up) {
    up_ = up;
    planes_.clear(up);
    points_.clear();
    origins_.clear();
}

PointEstimate LocalMap::place(const Eigen::Matrix3Xd& coarse, const Eigen::Isometry3d& predicted,
                              double kernel) const {
    return registerToPoints(points_, coarse, predicted, kernel, pointOptions_);
}

PointEstimate LocalMap::placeAnywhere(const Eigen::Matrix3Xd& coarse,
                                      const Eigen::Isometry3d& predicted, const SearchReach& reach,
                                      const Eigen::Matrix3f& upright) const {
    return searchPoints(points_, coarse, predicted, reach, upright, pointOptions_);
}

PointEstimate LocalMap::placeTurned(const Eigen::Matrix3Xd& coarse,
                                    const Eigen::Isometry3d& predicted, double enough,
                                    double reach_rad) const {
    return searchTurns(points_, coarse, predicted, reach_rad, enough, pointOptions_);
}

PointEstimate LocalMap::levelled(const ScanView& view, PointEstimate placed) const {
    if (!placed.valid || view.level.cols() == 0) return placed;
    const auto all = place(view.level, placed.pose, pointOptions_.least_kernel);
    if (!all.valid) return placed;
    const Eigen::Isometry3d moved = placed.pose.inverse() * all.pose;
    const Eigen::Vector3d up = placed.pose.linear().transpose() * up_,
                          turn = rotationLog(moved.linear());
    placed.inlierRatio = all.inlierRatio;
    placed.pose = placed.pose *
                  isometry(rotationExp(turn - up.dot(turn) * up), up.dot(moved.translation()) * up);
    return placed;
}

/** Of the rotation that points found, rad^2, right tangent. A sensor's rings mislead about all axes
 *  but the one that it spins about, across which it sees least: about that one the points err as
 *  their distances say. */
Eigen::Matrix3d LocalMap::turnCovariance(const Eigen::Matrix3Xd& points,
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
PlaneEstimate LocalMap::byPoints(const PointEstimate& placed,
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
    translation.unobservedAxes =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), up_).toRotationMatrix();
    estimate.inlierRatio = placed.inlierRatio;
    return estimate;
}

/** Static surfaces of a scan, fine enough that a motion by `probe` metres shows. */
paper::SurfaceNormals surfacesOf(const ScanView& view, double probe) {
    NormalsOptions options;
    options.voxel_size = probe / 2;
    options.max_radius = 3 * probe;
    return paper::estimateNormals(view.fine, options);
}

/** For each axis that the planes do not constrain, or hardly where an earlier scan was: where the
 *  points do not either, the prediction is taken and the axis is reported as unobserved. Where
 *  points say that the scan is where an earlier one was, the prediction is taken if the motion
 *  cannot have stopped so suddenly. Otherwise their answer stays, and it is reported as unobserved
 *  unless surfaces that face the axis confirm the standstill. */
void LocalMap::settleUnobserved(const ScanView& view, const Eigen::Isometry3d& predicted,
                                Motion motion, PlaneEstimate& found) const {
    auto& translation = found.translation;
    const bool rests = isWhereAScanWas(translation.translation);
    Eigen::Matrix3Xd doubtful = translation.unobservedAxes;
    constexpr double kThin = 0.006;  // of the planes' weight; smooth tunnels show up to 0.005
    const auto isStopped = [&](const Eigen::Vector3d& axis) {
        const Eigen::Vector3d off = translation.translation - predicted.translation();
        return rests && motion == Motion::kFast && std::abs(axis.dot(off)) > options_.probe;
    };
    const bool mayStand = rests && (motion != Motion::kFast || isStopped(found.weakestAxis));
    if (doubtful.cols() == 0 && mayStand && translation.observability[0] < kThin)
        doubtful = found.weakestAxis;
    if (doubtful.cols() == 0) return;
    paper::SurfaceNormals surfaces;
    if (rests) surfaces = surfacesOf(view, options_.probe);
    const auto isVertical = [&](const Eigen::Vector3d& axis) {
        constexpr double kVertical = 0.8;  // cosine
        return std::abs(axis.dot(up_)) > kVertical;
    };
    const auto stands = [&](const Eigen::Vector3d& axis) {
        return showsStandstill(
            points_, surfaces, found.pose(),
            {axis, isVertical(axis), options_.probe, pointOptions_.last_kernel / 2});
    };
    const auto isSeen = [&](const Eigen::Vector3d& axis) {
        // (Where only points that stand above the ground were placed, the ground shows the height.)
        const bool byAll = isVertical(axis) && view.level.cols() > 0;
        return pointsSee(points_, byAll ? view.level : view.coarse, found.pose(), axis,
                         options_.probe, pointOptions_);
    };
    Eigen::Matrix3Xd unseen(3, 0);
    for (Eigen::Index i = 0; i < doubtful.cols(); ++i) {
        const Eigen::Vector3d axis = doubtful.col(i);
        const Eigen::Matrix3d along = axis * axis.transpose();
        if (isStopped(axis) || !isSeen(axis))
            translation.translation += along * (predicted.translation() - translation.translation);
        else if (!rests || stands(axis))
            continue;
        translation.covariance += std::pow(planeOptions_.prior_sigma, 2) * along;
        unseen.conservativeResize(3, unseen.cols() + 1);
        unseen.rightCols<1>() = axis;
    }
    translation.unobservedAxes = unseen;
}

bool LocalMap::areNear(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) const {
    const Eigen::Isometry3d off = b.inverse() * a;
    return off.translation().norm() <= options_.max_deviation &&
           angleOf(off.linear()) <= options_.max_deviation_deg * kDeg;
}

PlaneEstimate LocalMap::refine(const Eigen::Matrix3Xd& thinned, const PointEstimate& placed) const {
    const Eigen::Matrix3d covariance =
        std::pow(options_.point_sigma_deg * kDeg, 2) * Eigen::Matrix3d::Identity();
    return registerToPlanes(planes_, thinned,
                            Prior::of(placed.pose, options_.point_sigma, covariance),
                            pointOptions_.last_kernel, planeOptions_);
}

PlaneEstimate LocalMap::registerPlanes(const ScanView& view, const PointEstimate& placed,
                                       const Eigen::Isometry3d& predicted, Motion motion,
                                       const std::optional<Eigen::Isometry3d>& start) const {
    const auto byPlanes = [&](const PointEstimate& from, const Eigen::Isometry3d& pose) {
        const auto prior =
            Prior::of(from.pose, options_.point_sigma, turnCovariance(view.coarse, from));
        return registerToPlanes(planes_, view.thinned, prior, pose, planeOptions_.last_kernel,
                                planeOptions_);
    };
    PointEstimate from = placed;
    auto found = byPlanes(from, start && areNear(*start, from.pose) ? *start : from.pose);
    // The points were placed wrongly where more of them fit where planes lead.
    constexpr unsigned kPatience = 2;
    for (unsigned i = 0; i < kPatience && found.valid && !isNear(found, from.pose); ++i) {
        const auto there =
            levelled(view, place(view.coarse, found.pose(), pointOptions_.least_kernel));
        if (!there.valid || there.inlierRatio <= from.inlierRatio) break;
        from = there;
        found = byPlanes(from, from.pose);
    }
    // Planes that lead to the prediction are two against one.
    const bool isAsPredicted = motion != Motion::kUnknown && isNear(found, predicted);
    if (!isNear(found, from.pose) && !isAsPredicted)
        found = byPoints(from, turnCovariance(view.coarse, from));
    found.rotation.unobservedAxes.resize(3, 0);  // points see every rotation
    found.isByPlanes = found.translation.unobservedAxes.cols() == 0;
    settleUnobserved(view, predicted, motion, found);
    return found;
}

LocalMap mapOfManyScans() {
    PlaneMapOptions planes;
    planes.ground_levels = 0;  // many scans leave no gaps
    return {{}, planes, {}, {}, {}};
}
}  // namespace delio::odometry
