#include "delio/odometry/prediction.h"

#include <algorithm>

#include "delio/core/geometry.h"

namespace delio {
std::vector<OptionField> PredictionOptions::fields() const {
    return {{"frames", &PredictionOptions::frames, "N: increments that the prediction is made of",
             1, 100}};
}

Eigen::Isometry3d LinearPrediction::predict(double duration_s) const {
    if (latestFirst_.empty()) return Eigen::Isometry3d::Identity();
    Vector6 moved = Vector6::Zero();
    double elapsed_s = 0, weight = static_cast<double>(latestFirst_.size());  // N - j + 1
    for (const auto& observed : latestFirst_) {
        moved += weight * poseLog(observed.increment);
        elapsed_s += weight * observed.duration_s;
        --weight;
    }
    return poseExp(duration_s / elapsed_s * moved);
}

void LinearPrediction::observe(const Eigen::Isometry3d& increment, double duration_s) {
    latestFirst_.push_front({increment, duration_s});
    if (latestFirst_.size() > frames_) latestFirst_.pop_back();
}

double errorGrowth(double unregistered_s) {
    constexpr double kOfSigma_s = 0.1, kMost_s = 60;
    return std::clamp(unregistered_s, kOfSigma_s, kMost_s) / kOfSigma_s;
}
}  // namespace delio
