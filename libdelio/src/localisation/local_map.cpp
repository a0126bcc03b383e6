#include "delio/localisation/local_map.h"

#include <algorithm>
#include <limits>

namespace delio {
namespace {
PlaneMapOptions denseMap() {
    PlaneMapOptions options;
    options.ground_levels = 0;  // many scans leave no gaps
    return options;
}
}  // namespace

LocalMap::LocalMap(std::shared_ptr<const StoredMap> map)
    : stored_(std::move(map)),
      isNear_(stored_->submaps().size(), false),
      map_({}, denseMap(), {}, {}, {}) {}

void LocalMap::comeNear(const Eigen::Vector3d& place) {
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

void LocalMap::take(Eigen::Index most) {
    while (most > 0 && !waiting_.empty()) {
        auto& cloud = waiting_.front();
        const Eigen::Index count = std::min(most, cloud.points.cols() - cloud.taken);
        map_.add(cloud.points.middleCols(cloud.taken, count), stored_->levelFrames()[cloud.submap]);
        cloud.taken += count;
        most -= count;
        if (cloud.taken == cloud.points.cols()) waiting_.pop_front();
    }
}

void LocalMap::load(const Eigen::Vector3d& place) {
    comeNear(place);
    take(std::numeric_limits<Eigen::Index>::max());
}

void LocalMap::follow(const Eigen::Vector3d& place) {
    constexpr Eigen::Index kMost = 10000;
    comeNear(place);
    take(kMost);
}
}  // namespace delio
