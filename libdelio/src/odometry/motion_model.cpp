#include "odometry/motion_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/portable_math.h"
#include "delio/core/geometry.h"

namespace delio::odometry {
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

void AdaptiveKernel::observe(const Eigen::Isometry3d& found, const Eigen::Isometry3d& predicted) {
    // An error of the rotation moves points at this distance by as much.
    constexpr double kTypicalRange_m = 20;
    constexpr std::size_t kMemory = 20;
    const Eigen::Isometry3d off = predicted.inverse() * found;
    const double angle = angleOf(off.linear());
    errors_m_.push_back(off.translation().norm() +
                        2 * kTypicalRange_m * portable::sin(std::abs(angle) / 2));
    if (errors_m_.size() > kMemory) errors_m_.pop_front();
}

bool AdaptiveKernel::isKnown() const {
    constexpr std::size_t kEnough = 3;
    return errors_m_.size() >= kEnough;
}

double AdaptiveKernel::width(double least, double most) const {
    if (!isKnown()) return most;
    double squares = 0;
    for (const double error : errors_m_) squares += error * error;
    const double sigma = std::sqrt(squares / static_cast<double>(errors_m_.size()));
    return std::clamp(3 * sigma, least, most);
}

namespace {
constexpr std::size_t kMemory = 20, kEnough = 3;

void remember(double square, std::deque<double>& squares) {
    squares.push_back(square / 3);
    if (squares.size() > kMemory) squares.pop_front();
}

/** With one of `likely` more, while there are few. */
double meanRoot(const std::deque<double>& squares, double likely) {
    const std::size_t more = squares.size() < kEnough ? 1 : 0;
    const double sum = std::accumulate(squares.begin(), squares.end(),
                                       static_cast<double>(more) * likely * likely);
    return std::sqrt(sum / static_cast<double>(squares.size() + more));
}
}  // namespace

void Unevenness::observe(const Eigen::Isometry3d& found, const Eigen::Isometry3d& even) {
    const Eigen::Isometry3d off = even.inverse() * found;
    remember(off.translation().squaredNorm(), squares_m2_);
    remember(std::pow(angleOf(off.linear()), 2), squares_rad2_);
}

Unevenness Unevenness::ofLatest(std::size_t count) const {
    Unevenness latest = *this;
    while (latest.squares_m2_.size() > count) {
        latest.squares_m2_.pop_front();
        latest.squares_rad2_.pop_front();
    }
    return latest;
}

TrajectoryPrior Unevenness::prior(double most) const {
    constexpr double kLikely_m = 0.02, kLikely_rad = 3 * M_PI / 180;
    constexpr double kLeast_m = 1e-4, kLeast_rad = 1e-5;  // of a sensor that stands still
    TrajectoryPrior prior;
    prior.unevenTranslation =
        std::clamp(meanRoot(squares_m2_, kLikely_m), kLeast_m, std::max(most, kLeast_m));
    prior.unevenRotation = std::max(meanRoot(squares_rad2_, kLikely_rad), kLeast_rad);
    return prior;
}
}  // namespace delio::odometry
