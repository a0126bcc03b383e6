#include "delio/loops/closure.h"

#include <algorithm>
#include <cmath>

#include "core/voxel_grid.h"
#include "delio/loops/height_image.h"

namespace delio::loops {
namespace {
constexpr double kDeg = M_PI / 180;
constexpr double kCoarse_m = 1, kThinned_m = 0.5;  // between points that are registered
/** What points say of where a submap lies, as an odometry takes it. */
constexpr double kPointSigma_m = 0.05, kPointSigma_deg = 1;
/** Of an axis that planes do not see: as good as nothing is known. */
constexpr double kUnseen_m = 10;

PlaneMapOptions denseMap() {
    PlaneMapOptions options;
    options.ground_levels = 0;  // many scans leave no gaps
    return options;
}

std::uint64_t columnOf(const Eigen::Vector3d& point) {
    return voxelKey(floorOf(point.x()), floorOf(point.y()), 0);
}

Eigen::Matrix3Xd thinned(const Eigen::Matrix3Xf& points, double spacing) {
    return firstOfVoxels(points, spacing).cast<double>();
}
}  // namespace

std::vector<OptionField> ClosureOptions::fields() const {
    return {
        {"min_overlap", &ClosureOptions::min_overlap,
         "share of the smaller submap's voxels of 0.5 m that both submaps fill", 0, 1},
        {"min_share", &ClosureOptions::min_share,
         "share of the points in voxels with a plane that have to lie on it", 0, 1},
        {"max_bare", &ClosureOptions::max_bare,
         "share of what stands in one submap that may be where the other saw bare ground", 0, 1},
        {"agreed", &ClosureOptions::agreed,
         "m; registered one to the other and the other to the one, submaps have to agree so far",
         1e-3, 10},
        {"agreed_deg", &ClosureOptions::agreed_deg, "deg; the same of the rotation", 1e-3, 90}};
}

RegistrableSubmap::RegistrableSubmap(const Eigen::Matrix3Xf& points)
    : planes_(denseMap()),
      points_(PointMapOptions{}),
      coarse_(thinned(points, kCoarse_m)),
      thinned_(thinned(points, kThinned_m)),
      standing_(aboveGround(points)) {
    const Eigen::Matrix3Xd all = points.cast<double>();
    planes_.add(all);
    points_.add(all);
    for (Eigen::Index i = 0; i < standing_.cols(); ++i)
        filled_.insert(voxelKey(standing_.col(i), kThinned_m));
    for (Eigen::Index i = 0; i < all.cols(); ++i) {
        const auto number = columns_.insert(columnOf(all.col(i)));
        if (number == tops_.size()) tops_.push_back(all(2, i));
        tops_[number] = std::max(tops_[number], all(2, i));
    }
}

odometry::PlaneEstimate RegistrableSubmap::registered(const RegistrableSubmap& other,
                                                    const Eigen::Isometry3d& guess) const {
    const PointRegistrationOptions points;
    const PlaneRegistrationOptions planes;
    const auto placed =
        odometry::registerToPoints(points_, other.coarse_, guess, points.first_kernel, points);
    if (!placed.valid) return odometry::predictedEstimate(guess, planes);
    const auto prior =
        odometry::Prior::of(placed.pose, kPointSigma_m,
                          std::pow(kPointSigma_deg * kDeg, 2) * Eigen::Matrix3d::Identity());
    auto found =
        odometry::registerToPlanes(planes_, other.thinned_, prior, points.last_kernel, planes);
    const auto& unseen = found.translation.unobservedAxes;
    found.translation.covariance += std::pow(kUnseen_m, 2) * unseen * unseen.transpose();
    return found;
}

double RegistrableSubmap::support(const RegistrableSubmap& other,
                                  const Eigen::Isometry3d& pose) const {
    constexpr double kLeast = 0.3;
    VoxelIndex theirs;
    double visible = 0, both = 0;
    for (Eigen::Index i = 0; i < other.standing_.cols(); ++i) {
        const Eigen::Vector3d point = pose * other.standing_.col(i);
        const auto key = voxelKey(point, kThinned_m);
        const std::size_t before = theirs.size();
        theirs.insert(key);
        if (theirs.size() == before) continue;
        const bool isFilled = filled_.find(key) != VoxelIndex::kNone;
        const auto column = columns_.find(columnOf(point));
        visible += isFilled || column == VoxelIndex::kNone || point.z() <= tops_[column];
        both += isFilled;
    }
    return both / std::max({1.0, visible, kLeast * static_cast<double>(theirs.size())});
}

double RegistrableSubmap::overlap(const RegistrableSubmap& other,
                                  const Eigen::Isometry3d& pose) const {
    VoxelIndex theirs, both;
    for (Eigen::Index i = 0; i < other.standing_.cols(); ++i) {
        const auto key = voxelKey(pose * other.standing_.col(i), kThinned_m);
        theirs.insert(key);
        if (filled_.find(key) != VoxelIndex::kNone) both.insert(key);
    }
    const std::size_t fewer = std::min(filled_.size(), theirs.size());
    return fewer == 0 ? 0 : static_cast<double>(both.size()) / static_cast<double>(fewer);
}

Closure closureOf(const ClosureEnd& from, const ClosureEnd& to, const Eigen::Isometry3d& guess,
                  const ClosureOptions& options) {
    Closure closure;
    closure.level = guess;
    const auto found = from.map.registered(to.map, guess);
    if (!found.valid) {
        closure.reason = "not registered";
        return closure;
    }
    closure.level = found.pose();
    closure.share = found.share;
    closure.overlap = from.map.overlap(to.map, closure.level);
    closure.increment = ofVehicle(incrementOf(found.rotation, found.translation),
                                  isometry(from.submap.level, Eigen::Vector3d::Zero()),
                                  isometry(to.submap.level, Eigen::Vector3d::Zero()));
    if (closure.share < options.min_share)
        closure.reason = "off the planes";
    else if (closure.overlap < options.min_overlap)
        closure.reason = "too little overlap";
    return closure;
}

void confirm(Closure& closure, const ClosureEnd& from, const ClosureEnd& to,
             const ClosureOptions& options) {
    const auto back = to.map.registered(from.map, closure.level.inverse());
    const Eigen::Isometry3d off = back.pose() * closure.level;
    const auto& unseen = back.translation.unobservedAxes;
    const Eigen::Vector3d apart =
        off.translation() - unseen * (unseen.transpose() * off.translation());
    if (!back.valid || apart.norm() > options.agreed ||
        angleOf(off.linear()) > options.agreed_deg * kDeg)
        closure.reason = "not the same both ways";
}
}  // namespace delio::loops
