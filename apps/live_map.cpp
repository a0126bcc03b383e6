#include "live_map.h"

#include <algorithm>
#include <cmath>

namespace delio {
namespace {
constexpr double kStep_m = 1;         // a scan goes into the map every so many metres
constexpr double kTurn_rad = 0.1;     // or so much rotation
constexpr float kReach_m = 60;        // of the points of a scan
constexpr float kPath_m = 0.1F;       // between places of the trajectory
constexpr double kCorrected_m = 0.2;  // a correction that is worth building the map again
constexpr std::size_t kMostWaiting = 4;
constexpr float kCell_m = 2;       // of the ground
constexpr float kSteepest = 0.2F;  // rise over run of the ground that is not seen

std::uint64_t keyOf(const Eigen::Vector3f& place, float edge) {
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis)
        key = key << 21 | (static_cast<std::uint64_t>(std::floor(place[axis] / edge)) & 0x1fffff);
    return key;
}

std::uint64_t cellOf(float x, float y) { return keyOf({x, y, 0}, kCell_m); }
}  // namespace

LiveMap::LiveMap(std::size_t mostPoints, double voxel_m)
    : mostPoints_(mostPoints),
      firstVoxel_m_(voxel_m),
      voxel_m_(voxel_m),
      thread_([this] { run(); }) {}

LiveMap::~LiveMap() {
    {
        const std::lock_guard lock(arrivals_);
        isClosing_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void LiveMap::add(const SlamScan& scan) {
    const Eigen::Matrix3d toMap = scan.pose.linear() * scan.scan.sensorPose.linear();
    const Eigen::Matrix3Xd& weak = scan.step.quality.unobservedTranslation;
    Arrived arrived{scan.node, scan.pose, scan.corrected, staticPoints(scan),
                    (toMap * weak).cast<float>()};
    {
        const std::lock_guard lock(arrivals_);
        if (waiting_.size() >= kMostWaiting) arrived.points.resize(3, 0);
        waiting_.push_back(std::move(arrived));
    }
    changed_.notify_all();
}

void LiveMap::run() {
    std::unique_lock lock(arrivals_);
    for (;;) {
        isBusy_ = false;
        changed_.notify_all();
        changed_.wait(lock, [&] { return isClosing_ || !waiting_.empty(); });
        if (isClosing_) return;
        const Arrived scan = std::move(waiting_.front());
        waiting_.pop_front();
        isBusy_ = true;
        lock.unlock();
        take(scan);
        lock.lock();
    }
}

void LiveMap::take(const Arrived& scan) {
    const std::lock_guard lock(map_);
    correct(scan.corrected);
    vehicle_ = scan.pose;
    weakAxes_ = scan.weakAxes;
    ++scans_;
    const Eigen::Vector3f at = scan.pose.translation().cast<float>();
    if (trajectory_.empty() || (trajectory_.back().second - at).norm() > kPath_m)
        trajectory_.emplace_back(scan.node, at);
    if (scan.points.cols() == 0) return;
    latest_ = scan.pose.cast<float>() * scan.points;
    if (!isWorthAdding(scan.pose)) return;
    mapped_ = scan.pose;
    insert(scan);
}

void LiveMap::correct(const std::vector<NodePose>& corrected) {
    for (const auto& [node, pose] : corrected) {
        const auto place = std::find_if(trajectory_.begin(), trajectory_.end(),
                                        [n = node](const auto& at) { return at.first >= n; });
        if (place == trajectory_.end()) return;
        const Eigen::Vector3d off = pose.translation() - place->second.cast<double>();
        if (place->first == node && off.norm() > kCorrected_m) return forget(node);
    }
}

std::uint64_t LiveMap::voxelOf(const Eigen::Vector3f& place) const {
    return keyOf(place, static_cast<float>(voxel_m_));
}

bool LiveMap::isWorthAdding(const Eigen::Isometry3d& pose) const {
    if (points_.empty()) return true;
    const Eigen::Isometry3d moved = mapped_.inverse() * pose;
    return moved.translation().norm() > kStep_m ||
           Eigen::AngleAxisd(moved.linear()).angle() > kTurn_rad;
}

/** What is left has the voxels of its own. */
template <typename Keeps>
void LiveMap::keep(const Keeps& keeps) {
    ++generation_;
    taken_.clear();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
        if (!keeps(i) || !taken_.insert(voxelOf(points_[i].position)).second) continue;
        points_[kept] = points_[i];
        nodes_[kept++] = nodes_[i];
    }
    points_.resize(kept);
    nodes_.resize(kept);
}

/** What later scans say was elsewhere is taken out, and viewers start again. */
void LiveMap::forget(std::size_t firstNode) {
    keep([&](std::size_t i) { return nodes_[i] < firstNode; });
    if (points_.empty()) lows_.clear();
    while (!trajectory_.empty() && trajectory_.back().first >= firstNode) trajectory_.pop_back();
}

void LiveMap::coarsen() {
    voxel_m_ *= 2;
    keep([](std::size_t) { return true; });
    lows_.clear();
}

/** The lowest of the cells around; far from them, no higher than a steep street would be. */
float LiveMap::groundAt(const Eigen::Vector3f& place) const {
    float ground = place.z();
    for (int i = -1; i <= 1; ++i)
        for (int k = -1; k <= 1; ++k) {
            const auto cell = lows_.find(cellOf(place.x() + static_cast<float>(i) * kCell_m,
                                                place.y() + static_cast<float>(k) * kCell_m));
            if (cell != lows_.end()) ground = std::min(ground, cell->second.second);
        }
    return ground;
}

void LiveMap::insert(const Arrived& scan) {
    const Eigen::Vector3f at = scan.pose.translation().cast<float>();
    std::vector<Eigen::Vector3f> added;
    for (const auto& place : latest_.colwise())
        if ((place - at).norm() < kReach_m && taken_.insert(voxelOf(place)).second)
            added.emplace_back(place);
    for (const auto& place : added) {
        auto& low = lows_.try_emplace(cellOf(place.x(), place.y()), Low{1e6F, 1e6F}).first->second;
        if (place.z() < low.lowest) {
            low.second = low.lowest;
            low.lowest = place.z();
        } else
            low.second = std::min(low.second, place.z());
    }
    const float below = groundAt(at);
    for (const auto& place : added) {
        const float highest = below + kSteepest * (place - at).norm();
        points_.push_back({place, place.z() - std::min(groundAt(place), highest)});
        nodes_.push_back(static_cast<std::uint32_t>(scan.node));
    }
    if (points_.size() > mostPoints_) coarsen();
}

LiveMap::News LiveMap::newsSince(const Seen& seen, std::size_t mostPoints) const {
    const std::lock_guard lock(map_);
    News news;
    news.from = seen.generation == generation_ ? seen : Seen{generation_, 0, 0};
    news.from.points = std::min(news.from.points, points_.size());
    news.from.poses = std::min(news.from.poses, trajectory_.size());
    const auto first = points_.begin() + static_cast<std::ptrdiff_t>(news.from.points);
    const auto count = std::min(mostPoints, points_.size() - news.from.points);
    news.points.assign(first, first + static_cast<std::ptrdiff_t>(count));
    for (std::size_t i = news.from.poses; i < trajectory_.size(); ++i)
        news.trajectory.push_back(trajectory_[i].second);
    news.allPoints = points_.size();
    news.allPoses = trajectory_.size();
    news.vehicle = vehicle_;
    news.weakAxes = weakAxes_;
    news.scans = scans_;
    news.isEnded = isEnded_;
    return news;
}

Eigen::Matrix3Xf LiveMap::latestScan() const {
    const std::lock_guard lock(map_);
    return latest_;
}

void LiveMap::waitForAll() {
    std::unique_lock lock(arrivals_);
    changed_.wait(lock, [&] { return waiting_.empty() && !isBusy_; });
}

void LiveMap::clear() {
    waitForAll();
    const std::lock_guard lock(map_);
    forget(0);
    scans_ = 0;
    voxel_m_ = firstVoxel_m_;
    latest_.resize(3, 0);
    weakAxes_.resize(3, 0);
    vehicle_ = mapped_ = Eigen::Isometry3d::Identity();
    isEnded_ = false;
}

void LiveMap::end() {
    waitForAll();
    const std::lock_guard lock(map_);
    isEnded_ = true;
}
}  // namespace delio
