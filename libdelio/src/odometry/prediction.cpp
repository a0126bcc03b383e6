#include "delio/odometry/prediction.h"

#include <algorithm>

#include "delio/core/motion.h"

namespace delio {
std::vector<OptionField> PredictionOptions::fields() const {
    return {{"frames", &PredictionOptions::frames, "N: increments that the prediction is made of",
             1, 100}};
}

Eigen::Isometry3d LinearPrediction::predict(double duration_s) const {
    Motion mean;
    const auto n = static_cast<double>(latestFirst_.size());
    for (std::size_t j = 0; j < latestFirst_.size(); ++j) {
        const double weight = 2 * (n - static_cast<double>(j)) / (n * (n + 1));
        const auto motion = Motion::of(latestFirst_[j].increment, latestFirst_[j].duration_s);
        mean.velocity += weight * motion.velocity;
        mean.turning += weight * motion.turning;
    }
    return mean.after(duration_s);
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
