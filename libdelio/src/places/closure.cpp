#include "places/closure.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/voxel_grid.h"
#include "places/descriptor.h"

namespace delio::places {
namespace {
constexpr double kDeg = M_PI / 180;
constexpr double kCoarse_m = 1, kThinned_m = 0.5;  // between points that are registered
/** Of an axis that planes do not see: as good as nothing is known. */
constexpr double kUnseen_m = 10;

/** Fraction of the points in voxels with a plane that have to lie on it: with less, the surfaces
 * are not the same ones. */
constexpr double kMinInlierRatio = 0.5;
/** Registered in both directions, submaps have to agree to this rotation, degrees: 0.2 m
 *  (ClosureOptions::agreed) at 25 m, which is where most of a submap's points lie. */
constexpr double kAgreed_deg = 0.5;

std::uint64_t columnOf(const Eigen::Vector3d& point) {
    return voxelKey(floorOf(point.x()), floorOf(point.y()), 0);
}

Eigen::Matrix3Xd thinned(const Eigen::Matrix3Xf& points, double spacing) {
    constexpr Eigen::Index kEnough = 1000;
    return firstOfVoxels(points, spacing, spacing / 4, kEnough).cast<double>();
}
}  // namespace

std::vector<OptionField> ClosureOptions::fields() const {
    return {
        {"min_overlap", &ClosureOptions::min_overlap,
         "share of the smaller submap's voxels of 0.5 m that both submaps fill", 0, 1},
        {"agreed", &ClosureOptions::agreed,
         "m; registered one to the other and the other to the one, submaps have to agree so far",
         1e-3, 10}};
}

RegistrableSubmap::RegistrableSubmap(const Eigen::Matrix3Xf& points)
    : map_(odometry::mapOfManyScans()),
      coarse_(thinned(points, kCoarse_m)),
      thinned_(thinned(points, kThinned_m)),
      standing_(standing(points)) {
    const Eigen::Matrix3Xd all = points.cast<double>(), above = aboveGround(points);
    map_.add(points, Eigen::Isometry3d::Identity());
    for (Eigen::Index i = 0; i < above.cols(); ++i)
        filled_.insert(voxelKey(above.col(i), kThinned_m));
    VoxelIndex standingVoxels;
    for (Eigen::Index i = 0; i < standing_.cols(); ++i)
        standingVoxels.insert(voxelKey(standing_.col(i), kThinned_m));
    count_ = standingVoxels.size();
    for (Eigen::Index i = 0; i < all.cols(); ++i) {
        const auto number = columns_.insert(columnOf(all.col(i)));
        if (number == tops_.size()) tops_.push_back(all(2, i));
        tops_[number] = std::max(tops_[number], all(2, i));
    }
}

odometry::PlaneEstimate RegistrableSubmap::registered(const RegistrableSubmap& other,
                                                      const Eigen::Isometry3d& guess) const {
    const auto placed = map_.place(other.coarse_, guess, PointRegistrationOptions().first_kernel);
    if (!placed.valid) return odometry::predictedEstimate(guess, {});
    auto found = map_.refine(other.thinned_, placed);
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

double RegistrableSubmap::seenThrough(const odometry::RangeImage& scan,
                                      const Eigen::Isometry3d& pose) const {
    constexpr double kMargin_m = 0.5, kFarthest_m = 30, kFewest = 50;
    const Eigen::Isometry3d toScan = pose.inverse();
    double free = 0, taken = 0;
    for (Eigen::Index i = 0; i < standing_.cols(); ++i) {
        const Eigen::Vector3d point = toScan * standing_.col(i);
        if (point.norm() > kFarthest_m) continue;
        const auto place = scan.at(point.cast<float>(), static_cast<float>(kMargin_m));
        free += place == odometry::Place::kFree;
        taken += place == odometry::Place::kTaken;
    }
    return free / std::max(free + taken, kFewest);
}

double RegistrableSubmap::overlap(const RegistrableSubmap& other,
                                  const Eigen::Isometry3d& pose) const {
    VoxelIndex theirs, both;
    for (Eigen::Index i = 0; i < other.standing_.cols(); ++i) {
        const auto key = voxelKey(pose * other.standing_.col(i), kThinned_m);
        theirs.insert(key);
        if (filled_.find(key) != VoxelIndex::kNone) both.insert(key);
    }
    const std::size_t fewer = std::min(count_, theirs.size());
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
    closure.inlierRatio = found.inlierRatio;
    closure.overlap = from.map.overlap(to.map, closure.level);
    closure.increment = ofVehicle(incrementOf(found.rotation, found.translation),
                                  isometry(from.submap.level, Eigen::Vector3d::Zero()),
                                  isometry(to.submap.level, Eigen::Vector3d::Zero()));
    if (closure.inlierRatio < kMinInlierRatio)
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
    if (!back.valid || apart.norm() > options.agreed || angleOf(off.linear()) > kAgreed_deg * kDeg)
        closure.reason = "not the same both ways";
}

namespace {
constexpr double kCell_m = HeightImage::kCell_m;
constexpr double kGround_m = 0.3;  // at most above the ground's height

std::uint64_t cellAt(double x, double y) {
    return voxelKey(floorOf(x / kCell_m), floorOf(y / kCell_m), 0);
}
}  // namespace

FreeSpace::FreeSpace(const HeightImage& image, const Eigen::Matrix3Xf& points) {
    const auto cells = image.cells();
    for (Eigen::Index i = 0; i < cells.cols(); ++i)
        standing_.insert(cellAt(cells(0, i), cells(1, i)));
    constexpr std::array<double, 3> kBeside{-kCell_m, 0, kCell_m};
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const auto x = static_cast<double>(points(0, i)), y = static_cast<double>(points(1, i));
        bool isBare = static_cast<double>(points(2, i)) - image.groundAt(x, y) < kGround_m;
        for (const double dx : kBeside)
            for (const double dy : kBeside)
                isBare = isBare && standing_.find(cellAt(x + dx, y + dy)) == VoxelIndex::kNone;
        if (isBare) bare_.insert(cellAt(x, y));
    }
}

double FreeSpace::conflict(const HeightImage& other, const Eigen::Isometry3d& pose) const {
    constexpr std::uint8_t kUpright = 2 | 4;  // 1 to 2 m, and 2 to 4 m
    constexpr double kFewest = 20;            // cells; fewer are no evidence
    double bare = 0, seen = 0;
    const auto cells = other.cells();
    for (Eigen::Index i = 0; i < cells.cols(); ++i) {
        if ((other.bands()[static_cast<std::size_t>(i)] & kUpright) != kUpright) continue;
        const Eigen::Vector3d at = pose * Eigen::Vector3d(cells(0, i), cells(1, i), 0);
        const auto cell = cellAt(at.x(), at.y());
        const bool isBare = bare_.find(cell) != VoxelIndex::kNone;
        bare += isBare;
        seen += isBare || standing_.find(cell) != VoxelIndex::kNone;
    }
    return bare / std::max(seen, kFewest);
}

std::shared_ptr<const DenseSubmap> DenseSubmapCache::at(std::size_t submap,
                                                        const std::function<DenseSubmap()>& make) {
    const auto known = std::find_if(recent_.begin(), recent_.end(),
                                    [&](const Recent& other) { return other.submap == submap; });
    Recent recent{submap, nullptr};
    if (known != recent_.end()) {
        recent = *known;
        recent_.erase(known);
    } else {
        recent.dense = std::make_shared<DenseSubmap>(make());
    }
    recent_.push_front(recent);
    if (recent_.size() > most_) recent_.pop_back();
    return recent.dense;
}
}  // namespace delio::places
