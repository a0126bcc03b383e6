#include "places.h"

#include <algorithm>

namespace delio::loops {
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

Eigen::Matrix3Xf Places::points(std::size_t submap) const {
    const auto floats = spool_->read(points_[submap]);
    return Eigen::Map<const Eigen::Matrix3Xf>(floats.data(), 3,
                                              static_cast<Eigen::Index>(floats.size() / 3));
}

std::shared_ptr<const Ground> Places::ground(std::size_t submap) {
    return grounds_.at(submap, [&] { return Ground(points(submap), sketches_[submap].image); });
}
}  // namespace delio::loops
