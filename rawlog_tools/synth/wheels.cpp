#include "wheels.h"

#include <cmath>

#include "random.h"

namespace delio::synth {
namespace {
constexpr std::uint64_t kKey = 0x0D0;
constexpr double kPeriod_s = 0.02, kBefore_s = 0.1;
constexpr double kNoise = 0.01;                             //!< of the distance of one period
constexpr double kYawNoise_rad = 2e-4, kOffset_rad = 2e-5;  //!< of a period's turn

double timeOf(std::size_t sample) { return kPeriod_s * static_cast<double>(sample) - kBefore_s; }
}  // namespace

std::optional<OdometrySample> Wheels::next(double stamp_s) {
    const double time_s = timeOf(samples_);
    if (time_s > stamp_s) return {};
    if (samples_ > 0) {
        const Eigen::Isometry3d moved =
            drive_.lidarPoseAt(timeOf(samples_ - 1)).inverse() * drive_.lidarPoseAt(time_s);
        Random random{seed_, kKey, samples_};
        const bool slips = time_s > model_.slipFirst_s && time_s <= model_.slipLast_s;
        const double scale = (1 + model_.scaleError) * (1 + (slips ? model_.slip : 0)) *
                             (1 + kNoise * random.normal()),
                     x_m = scale * moved.translation().x(), y_m = scale * moved.translation().y();
        x_m_ += std::cos(yaw_rad_) * x_m - std::sin(yaw_rad_) * y_m;
        y_m_ += std::sin(yaw_rad_) * x_m + std::cos(yaw_rad_) * y_m;
        yaw_rad_ +=
            std::atan2(moved(1, 0), moved(0, 0)) + kYawNoise_rad * random.normal() + kOffset_rad;
    }
    ++samples_;
    OdometrySample sample;
    sample.stamp_s = time_s;
    sample.pose.linear() = Eigen::AngleAxisd(yaw_rad_, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    sample.pose.translation() << x_m_, y_m_, 0;
    return sample;
}
}  // namespace delio::synth
