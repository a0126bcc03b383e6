#include "core/scan_trajectory.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "delio/core/error.h"

namespace delio {
Twist Twist::of(const Eigen::Isometry3d& increment, double duration_s) {
    const Vector6 twist = poseLog(increment) / duration_s;
    return {twist.head<3>(), twist.tail<3>()};
}

Eigen::Isometry3d Twist::after(double time_s) const {
    Vector6 twist;
    twist << time_s * velocity, time_s * turning;
    return poseExp(twist);
}

ScanTrajectory::ScanTrajectory(const std::vector<double>& times_s,
                               const std::vector<Eigen::Isometry3d>& poses)
    : times_s_(times_s), poses_(poses) {
    const auto increases = [&] {
        return std::adjacent_find(times_s.begin(), times_s.end(),
                                  [](double a, double b) { return !(a < b); }) == times_s.end();
    };
    if (poses.size() < 2 || times_s.size() != poses.size() || !increases())
        throw Error("a trajectory of " + std::to_string(poses.size()) + " poses at " +
                    std::to_string(times_s.size()) +
                    " times is invalid: it needs at least two poses with increasing times");
    for (std::size_t i = 1; i < poses.size(); ++i)
        motions_.push_back(
            Twist::of(poses[i - 1].inverse() * poses[i], times_s[i] - times_s[i - 1]));
}

ScanTrajectory::ScanTrajectory(const Twist& motion)
    : times_s_{0, 1}, poses_{Eigen::Isometry3d::Identity(), motion.after(1)}, motions_{motion} {}

ScanTrajectory ScanTrajectory::even(const std::vector<double>& times_s,
                                    const Eigen::Isometry3d& pose, const Twist& motion) {
    std::vector<Eigen::Isometry3d> poses;
    poses.reserve(times_s.size());
    for (const double time_s : times_s) poses.push_back(pose * motion.after(time_s - times_s[0]));
    return {times_s, poses};
}

Eigen::Isometry3d ScanTrajectory::at(double time_s) const {
    const auto next = std::upper_bound(times_s_.begin() + 1, times_s_.end() - 1, time_s);
    const auto i = static_cast<std::size_t>(next - times_s_.begin()) - 1;
    return poses_[i] * motions_[i].after(time_s - times_s_[i]);
}

ScanTrajectory placed(const Eigen::Isometry3d& pose, const ScanTrajectory& trajectory) {
    auto poses = trajectory.poses();
    for (auto& at : poses) at = pose * at;
    return {trajectory.times_s(), poses};
}

ScanTrajectory ScanTrajectory::seenFrom(double time_s) const {
    ScanTrajectory seen = *this;
    const Eigen::Isometry3d back = at(time_s).inverse();
    for (auto& time : seen.times_s_) time -= time_s;
    for (auto& pose : seen.poses_) pose = back * pose;
    return seen;
}

namespace {
/** How many parts a table has: in each one the pose turns by little, and a change of the twist,
 *  which the table rounds off, is short. */
unsigned partsOf(const ScanTrajectory& trajectory, double first_s, double last_s) {
    constexpr double kTurn_rad = 0.0018, kLongest_s = 1.0 / 640;
    constexpr unsigned kSamples = 8, kMost = 256;
    double most_rad = 0;
    Eigen::Matrix3d before = trajectory.at(first_s).linear();
    for (unsigned k = 1; k <= kSamples; ++k) {
        const Eigen::Matrix3d after =
            trajectory.at(first_s + k * (last_s - first_s) / kSamples).linear();
        most_rad = std::max(most_rad, angleOf(before.transpose() * after));
        before = after;
    }
    const double parts = std::max(kSamples * most_rad / kTurn_rad, (last_s - first_s) / kLongest_s);
    return static_cast<unsigned>(std::clamp<double>(std::ceil(parts), 1, kMost));
}
}  // namespace

template <typename Scalar>
PoseTableOf<Scalar>::PoseTableOf(const ScanTrajectory& trajectory, double first_s, double last_s)
    : first_s_(static_cast<Scalar>(first_s)) {
    constexpr double kLeast_s = 1e-9;
    const unsigned parts = partsOf(trajectory, first_s, last_s);
    const double step_s = std::max(last_s - first_s, kLeast_s) / parts;
    perSecond_ = static_cast<Scalar>(1 / step_s);
    parts_.reserve(parts);
    Eigen::Matrix4d before = trajectory.at(first_s).matrix();
    for (unsigned k = 1; k <= parts; ++k) {
        const Eigen::Matrix4d after = trajectory.at(first_s + k * step_s).matrix();
        parts_.push_back({before.cast<Scalar>(), (after - before).cast<Scalar>()});
        before = after;
    }
}
template class PoseTableOf<float>;
template class PoseTableOf<double>;
}  // namespace delio
