#include "places/map_tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/voxel_grid.h"
#include "odometry/spin_axis.h"
#include "places/descriptor.h"

namespace delio {
namespace {
std::uint64_t columnOf(const Eigen::Vector3d& point) {
    return voxelKey(floorOf(point.x()), floorOf(point.y()), 0);
}
}  // namespace

LoadedMap::LoadedMap(std::shared_ptr<const StoredMap> map)
    : stored_(std::move(map)),
      isNear_(stored_->submaps().size(), false),
      map_(odometry::mapOfManyScans()) {}

void LoadedMap::comeNear(const Eigen::Vector3d& place) {
    constexpr double kNear_m = 60, kFar_m = 170;  // beyond the radius of what is kept
    for (std::size_t i = 0; i < isNear_.size(); ++i) {
        const auto& level = stored_->levelFrames()[i];
        const double distance = (level.translation() - place).norm();
        if (distance > kFar_m) isNear_[i] = false;
        if (distance > kNear_m || isNear_[i]) continue;
        isNear_[i] = true;
        waiting_.push_back({i, stored_->points(i), 0});
    }
}

void LoadedMap::take(Eigen::Index most) {
    while (most > 0 && !waiting_.empty()) {
        auto& cloud = waiting_.front();
        const Eigen::Index count = std::min(most, cloud.points.cols() - cloud.taken);
        const Eigen::Matrix3Xf points = cloud.points.middleCols(cloud.taken, count);
        map_.add(points, stored_->levelFrames()[cloud.submap]);
        raiseTops(stored_->levelFrames()[cloud.submap] * points.cast<double>());
        cloud.taken += count;
        most -= count;
        if (cloud.taken == cloud.points.cols()) waiting_.pop_front();
    }
}

void LoadedMap::raiseTops(const Eigen::Matrix3Xd& points) {
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const auto number = columns_.insert(columnOf(points.col(i)));
        if (number == tops_.size()) tops_.push_back(points(2, i));
        tops_[number] = std::max(tops_[number], points(2, i));
    }
}

double LoadedMap::shareAt(const Eigen::Matrix3Xd& points, const Eigen::Isometry3d& pose,
                          double distance) const {
    constexpr double kLeast = 0.3;
    Eigen::Matrix3Xd visible(3, points.cols());
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const Eigen::Vector3d point = pose * points.col(i);
        const auto column = columns_.find(columnOf(point));
        if (column == VoxelIndex::kNone || point.z() <= tops_[column] + distance)
            visible.col(count++) = points.col(i);
    }
    visible.conservativeResize(3, count);
    if (count == 0) return 0;
    const auto all = static_cast<double>(points.cols()), counted = static_cast<double>(count);
    return map_.shareAt(visible, pose, distance) * counted / std::max(counted, kLeast * all);
}

void LoadedMap::load(const Eigen::Vector3d& place) {
    comeNear(place);
    take(std::numeric_limits<Eigen::Index>::max());
}

void LoadedMap::follow(const Eigen::Vector3d& place) {
    constexpr Eigen::Index kMost = 10000;
    comeNear(place);
    take(kMost);
}

namespace {
constexpr unsigned kConfirmed = 3;  // scans that have to agree before a place counts as found
constexpr unsigned kPatience = 5;   // scans that may disagree before the map counts as left
/** Minimum inlier ratio of a scan's points above the ground: half, because other traffic and parked
 *  cars may hide the rest. */
constexpr double kMinInlierRatio = 0.5;
/** Metres of path after which a vehicle outside the map is searched for again: less shows little
 * that is new. */
constexpr double kSearchSpacing_m = 5;
constexpr double kFine_m = 0.25, kThinned_m = 0.5, kCoarse_m = 1;

odometry::ScanView viewOf(const Eigen::Matrix3Xf& points) {
    odometry::ScanView view;
    view.fine = voxelCentroids(points, kFine_m);
    view.thinned = voxelCentroids(view.fine, kThinned_m).cast<double>();
    view.coarse = firstOfVoxels(view.fine, kCoarse_m).cast<double>();
    return view;
}

Eigen::Isometry3d turned(const Eigen::Matrix3d& rotation) {
    return isometry(rotation, Eigen::Vector3d::Zero());
}

double sigma_m(const Increment& pose) {
    return std::sqrt(pose.covariance.diagonal().head<3>().maxCoeff());
}
}  // namespace

std::vector<OptionField> LocalisationOptions::fields() const {
    using Me = LocalisationOptions;
    return {
        {"drift", &Me::drift,
         "assumed odometry drift outside the map, as a fraction of the path (standard deviation)",
         1e-6, 1}};
}

MapTracker::MapTracker(std::shared_ptr<const StoredMap> map, const PlaceSearchOptions& search,
                       const LocalisationOptions& options)
    : map_(std::move(map)), options_(options), search_(map_, search), local_(map_) {}

void MapTracker::expect(const Eigen::Isometry3d& vehicle) {
    constexpr double kOff_m = 3, kOff_rad = 0.1;
    now_.belief.vehicle = Increment{vehicle, Matrix6::Zero()};
    now_.belief.vehicle->covariance.diagonal() << Eigen::Vector3d::Constant(kOff_m * kOff_m),
        Eigen::Vector3d::Constant(kOff_rad * kOff_rad);
}

/** The latest scans, to be searched for together. */
void MapTracker::remember(const Eigen::Matrix3Xf& points) {
    constexpr std::size_t kMost = 5;
    constexpr double kSpacing_m = 0.2, kRadius_m = 50;
    Eigen::Matrix3Xf near(3, points.cols());
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        if (points.col(i).norm() <= kRadius_m) near.col(count++) = points.col(i);
    now_.recent.push_back({now_.odometry, firstOfVoxels(near.leftCols(count), kSpacing_m)});
    if (now_.recent.size() > kMost) now_.recent.pop_front();
}

/** Registers the scan to the map, from where it is predicted. */
std::optional<Increment> MapTracker::track(const Eigen::Matrix3Xf& points,
                                           const Eigen::Matrix3d& level, const Increment& predicted,
                                           MapFix& fix) {
    constexpr double kMeets_m = 0.3, kLeast_m = 0.5, kMost_m = 2;
    // Rows of posts are similar to each other, but less than to the right place.
    const double usual = (now_.where == Whereabouts::kInMap ? 0.8 : 0.85) * now_.usualInlierRatio;
    local_.follow(predicted.pose.translation());
    const auto& map = local_.map();
    fix.reason = points.cols() == 0 ? "no points" : "no map points here";
    if (!map.isUsable() || points.cols() == 0) return {};
    const odometry::ScanView view = viewOf(points);
    const auto placed = map.place(view.coarse, predicted.pose,
                                  std::clamp(3 * sigma_m(predicted), kLeast_m, kMost_m));
    fix.reason = "not registered to the map";
    if (!placed.valid) return {};
    auto found = map.registerPlanes(view, placed, predicted.pose, odometry::Motion::kFast);
    // Ground and ceilings match anywhere.
    const auto standing = places::standing((level * view.thinned).cast<float>());
    if (standing.cols() > 0)
        fix.inlierRatio =
            local_.shareAt(standing, found.pose() * turned(level.transpose()), kMeets_m);
    fix.reason = "inlier ratio too low";
    if (!found.valid || fix.inlierRatio < std::max(kMinInlierRatio, usual)) return {};
    fix.reason.clear();
    // Along axes that the map does not constrain, the odometry and its error continue.
    const Eigen::Matrix3d R = predicted.pose.linear();
    const Eigen::Matrix3d drifted = R * predicted.covariance.topLeftCorner<3, 3>() * R.transpose();
    const auto& unseen = found.translation.unobservedAxes;
    for (Eigen::Index i = 0; i < unseen.cols(); ++i)
        found.translation.covariance +=
            unseen.col(i).dot(drifted * unseen.col(i)) * unseen.col(i) * unseen.col(i).transpose();
    return incrementOf(found.rotation, found.translation);
}

/** Result for a scan that was compared with the map. Until the next scans confirm a place, the
 *  previous hypothesis is kept as well. */
void MapTracker::judge(const std::optional<Increment>& found, double inlierRatio) {
    constexpr double kForget = 0.1;
    const bool isInMap = now_.where == Whereabouts::kInMap;
    if (found) {
        auto& usual = now_.usualInlierRatio;
        usual = usual == 0 ? inlierRatio : (1 - kForget) * usual + kForget * inlierRatio;
        if (!isInMap && now_.confirmed == 0) now_.otherwise = now_.belief;
        now_.belief = {found, 0};
        now_.missed = 0;
        if (++now_.confirmed < kConfirmed) return;
        now_.where = Whereabouts::kInMap;
        now_.inVain = 0;
        return;
    }
    ++now_.missed;
    if (isInMap && now_.missed < kPatience) return;
    if (isInMap)
        now_.where = Whereabouts::kOutside;
    else if (now_.confirmed > 0)
        now_.belief = now_.otherwise;
    now_.confirmed = 0;
    now_.usualInlierRatio = 0;
}

double MapTracker::reach_m() const {
    constexpr double kLeast_m = 2;
    return kLeast_m + 3 * (options_.drift * now_.belief.unseen_m + sigma_m(*now_.belief.vehicle));
}

std::vector<std::size_t> MapTracker::nearSubmaps(double reach_m) const {
    constexpr double kNear_m = 25;
    std::vector<std::size_t> near;
    for (std::size_t i = 0; i < map_->submaps().size(); ++i)
        if ((map_->levelFrames()[i].translation() - now_.belief.vehicle->pose.translation())
                .head<2>()
                .norm() <= kNear_m + reach_m)
            near.push_back(i);
    return near;
}

bool MapTracker::isTimeToSearch() const {
    constexpr std::size_t kAtFirst = 5;
    constexpr double kRarest = 5;  // the longer in vain, the rarer
    const double spacing =
        std::min(1.0 + static_cast<double>(now_.inVain) / kAtFirst, kRarest) * kSearchSpacing_m;
    return now_.confirmed == 0 && now_.where != Whereabouts::kInMap &&
           (now_.scans <= kAtFirst || now_.unsearched_m >= spacing);
}

/** Latest points, in the latest scan's frame, levelled. */
Eigen::Matrix3Xf MapTracker::recentCloud(const Eigen::Matrix3d& level) const {
    const Eigen::Isometry3d here = now_.odometry * turned(level.transpose());
    Eigen::Index count = 0;
    for (const auto& seen : now_.recent) count += seen.points.cols();
    Eigen::Matrix3Xf cloud(3, count);
    count = 0;
    for (const auto& seen : now_.recent) {
        cloud.middleCols(count, seen.points.cols()) =
            (here.inverse() * seen.pose).cast<float>() * seen.points;
        count += seen.points.cols();
    }
    return cloud;
}

/** All of the map, or, where something is known, as far as that may be off. */
std::optional<Increment> MapTracker::search(const Eigen::Matrix3d& level, MapFix& fix) {
    constexpr double kFound_m = 0.1, kFound_rad = 0.01;
    const auto cloud = recentCloud(level);
    const auto& known = now_.belief.vehicle;
    const double reach = known ? reach_m() : std::numeric_limits<double>::infinity();
    const auto submaps = known ? nearSubmaps(reach) : std::vector<std::size_t>();
    if (cloud.cols() == 0 || (known && submaps.empty())) return {};
    now_.unsearched_m = 0;
    ++now_.inVain;
    fix.searched = true;
    const auto found = known ? search_.find(cloud, submaps) : search_.find(cloud);
    fix.reason = found.reason;
    if (!found.reason.empty()) return {};
    Increment there{found.pose * turned(level), Matrix6::Zero()};
    fix.reason = "found farther away than possible";
    if (known && (there.pose.translation() - known->pose.translation()).norm() > reach) return {};
    there.covariance.diagonal() << Eigen::Vector3d::Constant(kFound_m * kFound_m),
        Eigen::Vector3d::Constant(kFound_rad * kFound_rad);
    local_.load(there.pose.translation());
    return there;
}

MapFix MapTracker::add(const Increment& increment, const Eigen::Matrix3Xf& points,
                       const Eigen::Vector3d& up) {
    MapFix fix;
    fix.reason = "no search at this scan";
    const Eigen::Matrix3d level = odometry::turnedUp(up).cast<double>();
    const double moved_m = increment.pose.translation().norm();
    now_.odometry = now_.odometry * increment.pose;
    now_.unsearched_m += moved_m;
    for (auto* belief : {&now_.belief, &now_.otherwise}) {
        belief->unseen_m += moved_m;
        if (belief->vehicle && now_.scans > 0)
            belief->vehicle = chained(*belief->vehicle, increment);
    }
    ++now_.scans;
    remember(points);
    std::optional<Increment> found;
    if (now_.belief.vehicle) {
        found = track(points, level, *now_.belief.vehicle, fix);
        judge(found, fix.inlierRatio);
    }
    if (!found && isTimeToSearch())
        if (const auto there = search(level, fix)) {
            found = track(points, level, *there, fix);
            if (found) judge(found, fix.inlierRatio);
        }
    fix.measured = found.has_value();
    fix.where = now_.where;
    if (now_.belief.vehicle) fix.vehicle = *now_.belief.vehicle;
    return fix;
}

bool isAnchor(const MapFix& fix) { return fix.measured && fix.where == Whereabouts::kInMap; }
}  // namespace delio
