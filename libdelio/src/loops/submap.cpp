#include "delio/loops/submap.h"

#include "delio/core/geometry.h"
#include "delio/scan/spin_axis.h"
#include "delio/scan/voxel_grid.h"

namespace delio::loops {
std::vector<OptionField> SubmapOptions::fields() const {
    return {{"path", &SubmapOptions::path, "m; a submap ends after so much path", 1, 1e4},
            {"straight", &SubmapOptions::straight,
             "m; or so far from where it began, whichever comes first", 1, 1e4},
            {"spacing", &SubmapOptions::spacing, "m; its points are so far apart", 0.05, 2},
            {"radius", &SubmapOptions::radius, "m; what lies farther from the sensor is left out",
             5, 1e4}};
}

Eigen::Isometry3d levelPose(const Submap& submap, const std::vector<Eigen::Isometry3d>& poses) {
    return poses[submap.key] * isometry(submap.level, Eigen::Vector3d::Zero());
}

void SubmapBuilder::add(std::size_t node, const Eigen::Isometry3d& pose,
                        const Eigen::Matrix3Xf& points, const Eigen::Vector3d& up) {
    if (isComplete()) {
        submaps_.push_back(merged());
        ended_path_m_ = parts_.back().path_m;
        ended_m_ = parts_.back().pose.translation();
        parts_.clear();
    }
    const bool isFirst = parts_.empty() && submaps_.empty();
    const Eigen::Vector3d& before = parts_.empty() ? ended_m_ : parts_.back().pose.translation();
    const double path_m = parts_.empty() ? ended_path_m_ : parts_.back().path_m;
    parts_.push_back(
        {node, pose, points, up, isFirst ? 0 : path_m + (pose.translation() - before).norm()});
}

void SubmapBuilder::undo() noexcept {
    if (!parts_.empty()) parts_.pop_back();
}

bool SubmapBuilder::isComplete() const {
    if (parts_.empty()) return false;
    const auto &begin = parts_.front(), &end = parts_.back();
    return end.path_m - begin.path_m >= options_.path ||
           (end.pose.translation() - begin.pose.translation()).norm() >= options_.straight;
}

Submap SubmapBuilder::merged() const {
    const Part& key = parts_[parts_.size() / 2];
    Submap submap;
    submap.first = parts_.front().node;
    submap.key = key.node;
    submap.last = parts_.back().node;
    submap.path_m = key.path_m;
    submap.level = scan::turnedUp(key.up).cast<double>().transpose();
    Eigen::Index count = 0, used = 0;
    for (const auto& part : parts_) count += part.points.cols();
    Eigen::Matrix3Xf all(3, count);
    for (const Part& part : parts_) {
        const Eigen::Isometry3f placed =
            (submap.level.transpose() * (key.pose.inverse() * part.pose)).cast<float>();
        for (Eigen::Index k = 0; k < part.points.cols(); ++k)
            if (part.points.col(k).norm() <= options_.radius)
                all.col(used++) = placed * part.points.col(k);
    }
    submap.points = scan::firstOfVoxels(all.leftCols(used), options_.spacing);
    return submap;
}

std::vector<Submap> SubmapBuilder::finish() {
    if (!parts_.empty()) submaps_.push_back(merged());
    parts_.clear();
    return std::move(submaps_);
}
}  // namespace delio::loops
