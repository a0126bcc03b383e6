#include "places.h"

#include <algorithm>

#include "delio/scan/voxel_grid.h"
#include "delio/surfaces/normals.h"

namespace delio::loops {
namespace {
/** Enough for the directions of walls, at a quarter of the time. */
constexpr double kThinned_m = 0.6;
}  // namespace

Sketch::Sketch(const Eigen::Matrix3Xf& points)
    : azimuths(surfaces::estimateNormals(scan::firstOfVoxels(points, kThinned_m), {})),
      image(points) {}

void Places::add(const Eigen::Matrix3Xf& points) {
    if (!spool_) spool_.emplace(folder_, "submaps", "--no-loops");
    points_.push_back(spool_->append(points.data(), static_cast<std::size_t>(points.size())));
    sketches_.emplace_back(points);
}

const std::vector<Shift>& Places::repetitions(std::size_t submap, double reach) {
    constexpr double kApart_m = 4;  // nearer, walls along the way look alike, and are one place
    constexpr std::size_t kMost = 6;
    repetitions_.resize(sketches_.size());
    auto& shifts = repetitions_[submap];
    if (shifts.empty()) {
        const auto& image = sketches_[submap].image;
        shifts = shiftsOf(image, image, 0, Eigen::Vector2d::Zero(), reach, kApart_m, kMost);
        if (!shifts.empty()) shifts.erase(shifts.begin());  // itself
    }
    return shifts;
}

std::shared_ptr<const Ground> Places::ground(std::size_t submap) {
    constexpr std::size_t kMost = 5;  // a submap and those it is compared with, next to each other
    const auto known = std::find_if(recent_.begin(), recent_.end(),
                                    [&](const Recent& other) { return other.submap == submap; });
    Recent recent{submap, nullptr};
    if (known != recent_.end()) {
        recent = *known;
        recent_.erase(known);
    } else {
        const auto floats = spool_->read(points_[submap]);
        const Eigen::Map<const Eigen::Matrix3Xf> points(
            floats.data(), 3, static_cast<Eigen::Index>(floats.size() / 3));
        recent.ground = std::make_shared<Ground>(
            Ground{RegistrableSubmap(points), FreeSpace(sketches_[submap].image, points)});
    }
    recent_.push_front(recent);
    if (recent_.size() > kMost) recent_.pop_back();
    return recent.ground;
}
}  // namespace delio::loops
