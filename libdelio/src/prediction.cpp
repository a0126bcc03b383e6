#include "delio/prediction.h"

#include "delio/motion.h"

namespace delio {
using mrpt::poses::CPose3D;

std::vector<OptionField> PredictionOptions::fields() {
    return {{"frames", &frames, "N: increments that the prediction is made of", 1, 100}};
}

CPose3D LinearPrediction::predict(double duration_s) const {
    Motion mean;
    const auto n = static_cast<double>(latestFirst_.size());
    for (std::size_t j = 0; j < latestFirst_.size(); ++j) {
        const double weight = 2 * (n - static_cast<double>(j)) / (n * (n + 1));
        const auto motion = Motion::of(latestFirst_[j].increment, latestFirst_[j].duration_s);
        mean.velocity += weight * motion.velocity;
        mean.turning += weight * motion.turning;
    }
    const Eigen::Isometry3d pose = mean.after(duration_s);
    return {Eigen::Matrix3d(pose.rotation()), Eigen::Vector3d(pose.translation())};
}

void LinearPrediction::observe(const CPose3D& increment, double duration_s) {
    latestFirst_.push_front({increment, duration_s});
    if (latestFirst_.size() > frames_) latestFirst_.pop_back();
}
}  // namespace delio
