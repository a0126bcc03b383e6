#include "slam/specific_force.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "delio/core/geometry.h"

namespace delio {
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {
constexpr double kLongestGap_s = 0.05;
}  // namespace

void SpecificForce::add(const ImuSample& sample) {
    if (std::isfinite(sample.stamp_s) && sample.rate_radps.allFinite() &&
        sample.acceleration_mps2.allFinite())
        waiting_.add(sample);
}

/** Samples may come as late as the scan after the one that they belong to. */
void SpecificForce::addScan(double stamp_s, const Vector3d& bias) {
    scans_s_.push_back(stamp_s);
    if (scans_s_.size() > 2) integrate(scans_s_[0], scans_s_[1]);
    bias_ = bias;
}

std::vector<std::optional<ForceBetween>> SpecificForce::take() {
    while (scans_s_.size() > 1) integrate(scans_s_[0], scans_s_[1]);
    return std::move(found_);
}

void SpecificForce::integrate(double from_s, double to_s) {
    if (!(to_s > from_s)) readings_.clear();  // the clock was set back
    waiting_.takeUpTo(to_s + kLongestGap_s, 0, [&](const ImuSample& sample) {
        const bool isLater = readings_.empty() || sample.stamp_s > readings_.back().time_s;
        if (isLater)
            readings_.push_back({sample.stamp_s, sample.rate_radps, sample.acceleration_mps2});
    });
    while (readings_.size() > 1 && readings_[1].time_s <= from_s) readings_.pop_front();
    found_.push_back(between(from_s, to_s));
    scans_s_.pop_front();
}

/** Between two readings. */
std::optional<SpecificForce::Reading> SpecificForce::readingAt(double time_s) const {
    const auto after =
        std::lower_bound(readings_.begin(), readings_.end(), time_s,
                         [](const Reading& reading, double t_s) { return reading.time_s < t_s; });
    if (after == readings_.end() || (after == readings_.begin() && after->time_s != time_s))
        return {};
    if (after->time_s == time_s) return *after;
    const Reading& before = *std::prev(after);
    const double part = (time_s - before.time_s) / (after->time_s - before.time_s);
    return Reading{time_s, before.rate + part * (after->rate - before.rate),
                   before.force + part * (after->force - before.force)};
}

/** The force changes evenly from one reading to the next. */
std::optional<ForceBetween> SpecificForce::between(double from_s, double to_s) const {
    const auto first = readingAt(from_s), last = readingAt(to_s);
    if (!first || !last || !(to_s > from_s)) return {};
    ForceBetween sum;
    sum.duration_s = to_s - from_s;
    Matrix3d turned = Matrix3d::Identity();
    Reading before = *first;
    const auto goTo = [&](const Reading& next) {
        const double passed_s = next.time_s - before.time_s;
        const Vector3d start = turned * before.force;
        turned = turned * rotationExp(((before.rate + next.rate) / 2 - bias_) * passed_s);
        const Vector3d end = turned * next.force;
        sum.twice += passed_s * (sum.once + passed_s / 6 * (2 * start + end));
        sum.once += passed_s / 2 * (start + end);
        before = next;
        return passed_s <= kLongestGap_s;
    };
    for (const Reading& reading : readings_) {
        if (reading.time_s <= from_s) continue;
        if (reading.time_s >= to_s) break;
        if (!goTo(reading)) return {};
    }
    if (!goTo(*last)) return {};
    return sum;
}
}  // namespace delio
