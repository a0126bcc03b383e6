#include "delio/core/pose_table.h"

#include <algorithm>

namespace delio {
PoseTable::PoseTable(const Course& course, double first_s, double last_s) : first_s_(first_s) {
    constexpr unsigned kParts = 256;
    constexpr double kLeast_s = 1e-9;
    const double step_s = std::max(last_s - first_s, kLeast_s) / kParts;
    perSecond_ = 1 / step_s;
    for (unsigned k = 0; k <= kParts; ++k) poses_.push_back(course.at(first_s + k * step_s));
}

Eigen::Isometry3d PoseTable::at(double time_s) const {
    const double at =
        std::clamp((time_s - first_s_) * perSecond_, 0.0, static_cast<double>(poses_.size() - 2));
    const auto k = static_cast<std::size_t>(at);
    const double share = (time_s - first_s_) * perSecond_ - static_cast<double>(k);
    Eigen::Isometry3d pose;
    pose.matrix() = (1 - share) * poses_[k].matrix() + share * poses_[k + 1].matrix();
    return pose;
}
}  // namespace delio
