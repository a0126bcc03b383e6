#include "delio/prediction.h"

#include <mrpt/poses/Lie/SE.h>

#include <Eigen/Dense>

namespace delio {
using SE3 = mrpt::poses::Lie::SE<3>;

std::vector<OptionField> PredictionOptions::fields() {
    return {{"frames", &frames, "N: increments that the prediction is made of", 1, 100}};
}

mrpt::poses::CPose3D LinearPrediction::predict(double duration_s) const {
    Eigen::Matrix<double, 6, 1> mean = Eigen::Matrix<double, 6, 1>::Zero();
    const auto n = static_cast<double>(latestFirst_.size());
    for (std::size_t j = 0; j < latestFirst_.size(); ++j)
        mean += duration_s / latestFirst_[j].duration_s * 2 * (n - static_cast<double>(j)) /
                (n * (n + 1)) * SE3::log(latestFirst_[j].increment).asEigen();
    return SE3::exp(SE3::tangent_vector(mean));
}

void LinearPrediction::observe(const mrpt::poses::CPose3D& increment, double duration_s) {
    latestFirst_.push_front({increment, duration_s});
    if (latestFirst_.size() > frames_) latestFirst_.pop_back();
}
}  // namespace delio
