#include "odometry/wheel_prior.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "delio/core/geometry.h"
#include "delio/core/text.h"

namespace delio::odometry {
namespace {
using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kBeyondLast_s = 0.1;  //!< a speed is taken to last so long

Isometry3d between(const Isometry3d& from, const Isometry3d& to, double share) {
    const Eigen::Quaterniond a(from.linear()), b(to.linear());
    return isometry(a.slerp(share, b).toRotationMatrix(),
                    from.translation() + share * (to.translation() - from.translation()));
}
}  // namespace

void WheelPrior::add(const OdometrySample& sample) {
    const bool isUsable = std::isfinite(sample.stamp_s) && sample.pose.matrix().allFinite() &&
                          (!sample.sensorPose || sample.sensorPose->matrix().allFinite());
    if (!isUsable || !waiting_.add(sample)) ++dropped_;
}

void WheelPrior::advance(const ScanClock& scan, const Isometry3d& sensorPose) {
    constexpr double kSame_s = 1e-3, kMemory_s = 10;
    const double shift_s = scan.clock_s - scan.time_s;
    if (std::abs(shift_s - shift_s_) > kSame_s) {  // a clock was set, or a pause
        ++run_;
        speed_mps_.reset();
    }
    shift_s_ = shift_s;
    const double end_s = scan.time_s + scan.last_s + kBeyondLast_s;
    waiting_.takeUpTo(end_s, shift_s, [&](const OdometrySample& sample) {
        if (sample.sensorPose) framePose_ = sample.sensorPose;
        use(sample.stamp_s - shift_s, sample.pose);
    });
    const Isometry3d frame = framePose_.value_or(Isometry3d::Identity());
    lidarPose_ = frame.inverse() * sensorPose;
    while (!readings_.empty() && readings_.front().time_s < end_s - kMemory_s)
        readings_.pop_front();
    covered_ = readingAt(scan.time_s).has_value();
}

/** A speed that no vehicle has, or that changes faster than a vehicle's does, is a jump of the
 *  odometry's frame. */
void WheelPrior::use(double time_s, const Isometry3d& pose) {
    constexpr double kMost_mps = 80, kMost_radps = 3.5, kMost_mps2 = 20, kNoise_mps = 2,
                     kNoise_rad = 0.1;
    const Isometry3d placed = normalised(pose);
    if (readings_.empty()) {
        ++samples_;
        readings_.push_back({time_s, placed, run_});
        return;
    }
    const Reading& last = readings_.back();
    const double passed_s = time_s - last.time_s;
    if (!(passed_s > 0)) {
        ++dropped_;
        return;
    }
    ++samples_;
    const Isometry3d moved = last.pose.inverse() * placed;
    const Vector3d speed_mps = moved.translation() / passed_s;
    const bool isFast = speed_mps.norm() > kMost_mps ||
                        angleOf(moved.linear()) > kMost_radps * passed_s + kNoise_rad;
    const bool isSudden =
        speed_mps_ && (speed_mps - *speed_mps_).norm() > kMost_mps2 * passed_s + kNoise_mps;
    if (isFast || isSudden) {
        ++jumps_;
        ++run_;
        speed_mps_.reset();
    } else {
        speed_mps_ = speed_mps;
    }
    readings_.push_back({time_s, placed, run_});
}

/** At a speed that is constant from one sample to the next, and for a moment after the last one. */
std::optional<WheelPrior::Reading> WheelPrior::readingAt(double time_s) const {
    constexpr double kLongest_s = 0.5;
    const auto next =
        std::upper_bound(readings_.begin(), readings_.end(), time_s,
                         [](double time, const Reading& r) { return time < r.time_s; });
    if (next == readings_.begin()) return {};
    const Reading& before = *std::prev(next);
    if (before.time_s == time_s) return before;
    if (next == readings_.end()) {
        if (time_s - before.time_s > kBeyondLast_s || !speed_mps_) return {};
        const Vector3d onward = *speed_mps_ * (time_s - before.time_s);
        return Reading{time_s, before.pose * isometry(Eigen::Matrix3d::Identity(), onward),
                       before.run};
    }
    const double gap_s = next->time_s - before.time_s;
    if (before.run != next->run || gap_s > kLongest_s) return {};
    return Reading{time_s,
                   odometry::between(before.pose, next->pose, (time_s - before.time_s) / gap_s),
                   before.run};
}

std::optional<WheelStep> WheelPrior::unscaled(double from_s, double to_s) const {
    const auto from = readingAt(from_s), to = readingAt(to_s);
    if (!from || !to || from->run != to->run) return {};
    const Isometry3d moved = from->pose.inverse() * to->pose;
    const Eigen::Matrix3d toLidar = lidarPose_.linear().transpose();
    return WheelStep{toLidar * moved.translation(), toLidar * lidarPose_.translation(), 0};
}

std::optional<WheelStep> WheelPrior::between(double from_s, double to_s) const {
    constexpr double kUnknown = 0.05, kLeast_m = 0.01;
    auto step = unscaled(from_s, to_s);
    if (!step) return {};
    step->moved *= scale_;
    step->sigma_m = kLeast_m + sigma_.value_or(kUnknown) * step->moved.norm();
    return step;
}

/** A part of the way is that of the scans' noise: short stretches show nothing. */
void WheelPrior::observe(double from_s, double to_s, const Isometry3d& increment) {
    constexpr double kLeast_m = 2, kSame_s = 1e-6;
    const auto step = unscaled(from_s, to_s);
    if (!step || (open_ && std::abs(open_->end_s - from_s) > kSame_s)) open_.reset();
    if (!step) return;
    if (!open_) open_.emplace();
    const Eigen::Matrix3d turned = increment.linear();
    open_->lidar +=
        open_->turned * (increment.translation() - (turned * step->lever - step->lever));
    open_->wheels += open_->turned * step->moved;
    open_->turned = open_->turned * turned;
    open_->end_s = to_s;
    if (std::max(open_->lidar.norm(), open_->wheels.norm()) >= kLeast_m) compare();
}

bool WheelPrior::Stretch::isOff(double scale) const {
    constexpr double kNoise_m = 0.05, kShare = 0.03;
    return residual_m(scale) > kNoise_m + kShare * lidar.norm();
}

bool WheelPrior::isScalePlausible() const {
    constexpr double kLeast = 0.8, kMost = 1.25;
    return scale_ >= kLeast && scale_ <= kMost;
}

void WheelPrior::compare() {
    constexpr std::size_t kMemory = 200;
    constexpr double kSlip_s = 2;
    stretches_.push_back(*open_);
    open_.reset();
    if (stretches_.size() > kMemory) stretches_.pop_front();
    ++compared_;
    scale_ = scaleOfStretches();
    const Stretch& latest = stretches_.back();
    if (latest.isOff(scale_)) {
        ++contradicting_;
        suspended_s_ = latest.end_s + kSlip_s;
    }
    judge();
}

/** Least squares over those stretches that are near the median. */
double WheelPrior::scaleOfStretches() const {
    constexpr double kNear = 0.03;
    std::vector<double> ratios;
    for (const Stretch& each : stretches_)
        if (each.wheels.norm() > 0)
            ratios.push_back(each.lidar.dot(each.wheels) / each.wheels.squaredNorm());
    if (ratios.empty()) return 0;
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::nth_element(ratios.begin(), middle, ratios.end());
    const double median = *middle;
    double both = 0, squares = 0;
    for (const Stretch& each : stretches_) {
        if ((each.lidar - median * each.wheels).norm() > kNear * each.lidar.norm()) continue;
        both += each.lidar.dot(each.wheels);
        squares += each.wheels.squaredNorm();
    }
    return squares > 0 ? both / squares : median;
}

/** Trusted while no more than three of the latest ten stretches are off. */
void WheelPrior::judge() {
    constexpr std::size_t kLatest = 10, kMostBad = 3, kGoodAgain = 1;
    std::size_t bad = 0, seen = 0, good = 0;
    double squares = 0;
    for (auto each = stretches_.rbegin(); each != stretches_.rend(); ++each, ++seen) {
        const bool isOff = each->isOff(scale_);
        bad += isOff && seen < kLatest;
        if (isOff) continue;
        squares += std::pow(each->residual_m(scale_) / each->lidar.norm(), 2);
        ++good;
    }
    // Of three axes.
    if (good >= kFewest) sigma_ = std::sqrt(squares / (3 * static_cast<double>(good)));
    if (bad > kMostBad || !isScalePlausible()) trusted_ = false;
    if (seen >= kFewest && bad <= kGoodAgain && isScalePlausible()) trusted_ = true;
    wasTrusted_ = wasTrusted_ || trusted_;
}

void WheelPrior::count(double time_s, bool carried) {
    if (samples_ == 0) return;
    ++scans_;
    carried_ += carried;
    without_ += !covered_;
    distrusted_ += covered_ && wasTrusted_ && !isTrustedAt(time_s);
}

std::optional<OdometryReport> WheelPrior::report() const {
    if (samples_ + dropped_ == 0 && waiting_.isEmpty()) return {};
    OdometryReport report;
    report.samples = samples_;
    report.dropped = dropped_;
    report.jumps = jumps_;
    report.scans = scans_;
    report.scansWithout = without_;
    report.scansCarried = carried_;
    report.compared = compared_;
    report.contradicting = contradicting_;
    report.scale = scale_;
    report.sigma = sigma_;
    explain(report);
    return report;
}

void WheelPrior::explain(OdometryReport& report) const {
    constexpr double kFew = 0.02;
    const auto say = [&](const std::string& text) { report.findings.push_back(text); };
    const auto of = [&](std::size_t scans) {
        return std::to_string(scans) + " of " + std::to_string(scans_) + " scans";
    };
    if (dropped_ > 0)
        say(std::to_string(dropped_) +
            " odometry samples are ignored: not finite, or with a stamp that does not increase");
    if (jumps_ > 0)
        say("the odometry jumps " + std::to_string(jumps_) +
            " times faster than a vehicle moves: these intervals are not used");
    if (samples_ == 0 ? !waiting_.isEmpty() : without_ == scans_ && scans_ >= kFewest)
        return say(
            "the odometry is not used: none of its samples lies between two scans; "
            "its stamps seem to come from another clock");
    if (static_cast<double>(without_) > kFew * static_cast<double>(scans_))
        say("no odometry samples for " + of(without_));
    if (distrusted_ > 0)
        say("the odometry contradicts the scans (slipping wheels?): not used for " +
            of(distrusted_));
    if (wasTrusted_ || compared_ < kFewest) return;
    if (isScalePlausible())
        say("the odometry is not used: it contradicts the scans on " +
            std::to_string(contradicting_) + " of " + std::to_string(compared_) +
            " stretches of 2 m");
    else
        say("the odometry is not used: the scans' distances are " + rounded(scale_, 3) +
            " times its own");
}
}  // namespace delio::odometry
