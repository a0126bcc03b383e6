#include "compensation.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "delio/scan/rings.h"

namespace delio::io {
namespace {
struct Beam {
    double time_s, azimuth;
    std::uint16_t ring;
};

double turned(double angle) { return std::remainder(angle, 2 * M_PI); }

/** Near enough for motion to show, and far enough that where a beam leaves the sensor does not. */
std::vector<Beam> beamsOf(const Scan& scan) {
    const auto& x = scan.points->getPointsBufferRef_x();
    const auto& y = scan.points->getPointsBufferRef_y();
    const auto& z = scan.points->getPointsBufferRef_z();
    std::vector<std::uint16_t> rings = scan.rings;
    if (rings.empty()) {
        Eigen::Matrix3Xf points(3, static_cast<Eigen::Index>(x.size()));
        for (std::size_t i = 0; i < x.size(); ++i)
            points.col(static_cast<Eigen::Index>(i)) << x[i], y[i], z[i];
        if (!points.allFinite()) return {};
        rings = scan::ringsOf(points);
    }
    constexpr float kNear = 2, kFar = 30;
    std::vector<Beam> beams;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const float range = std::hypot(x[i], y[i]);
        if (range > kNear && range < kFar)
            beams.push_back({scan.times_s[i], std::atan2(y[i], x[i]), rings[i]});
    }
    std::stable_sort(beams.begin(), beams.end(), [](const Beam& a, const Beam& b) {
        return a.ring != b.ring ? a.ring < b.ring : a.time_s < b.time_s;
    });
    return beams;
}

template <typename Value>
Value quantile(std::vector<Value> values, double share) {
    const auto at = values.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/** Radians a second from points that follow each other; 0 where they do not tell. */
double rateOf(const std::vector<Beam>& beams) {
    constexpr double kSoon_s = 0.005;
    std::vector<double> rates;
    for (std::size_t i = 1; i < beams.size(); ++i) {
        const double passed_s = beams[i].time_s - beams[i - 1].time_s;
        if (beams[i].ring == beams[i - 1].ring && passed_s > 0 && passed_s < kSoon_s)
            rates.push_back(turned(beams[i].azimuth - beams[i - 1].azimuth) / passed_s);
    }
    constexpr std::size_t kFewest = 500;
    return rates.size() < kFewest ? 0 : quantile(rates, 0.5);
}

/** Of each beam, how far its azimuth is from that of an even turn: its ring's median is 0. */
std::vector<double> deviations(const std::vector<Beam>& beams, double rate) {
    std::vector<double> all;
    for (std::size_t begin = 0; begin < beams.size();) {
        std::size_t end = begin;
        while (end < beams.size() && beams[end].ring == beams[begin].ring) ++end;
        const auto off = [&](std::size_t i) { return beams[i].azimuth - rate * beams[i].time_s; };
        double sine = 0, cosine = 0;
        for (std::size_t i = begin; i < end; ++i) {
            sine += std::sin(off(i));
            cosine += std::cos(off(i));
        }
        const double mean = std::atan2(sine, cosine);
        std::vector<double> ring;
        for (std::size_t i = begin; i < end; ++i) ring.push_back(turned(off(i) - mean));
        const double middle = quantile(ring, 0.5);
        for (const double deviation : ring) all.push_back(deviation - middle);
        begin = end;
    }
    return all;
}

/** What is left of the rate, by least squares. */
double slopeOf(const std::vector<Beam>& beams, const std::vector<double>& deviations) {
    double time = 0, deviation = 0, covariance = 0, variance = 0;
    const auto count = static_cast<double>(beams.size());
    for (std::size_t i = 0; i < beams.size(); ++i) {
        time += beams[i].time_s / count;
        deviation += deviations[i] / count;
    }
    for (std::size_t i = 0; i < beams.size(); ++i) {
        const double since = beams[i].time_s - time;
        covariance += since * (deviations[i] - deviation);
        variance += since * since;
    }
    return variance > 0 ? covariance / variance : 0;
}
}  // namespace

std::optional<bool> isMotionCompensated(const Scan& scan) {
    if (scan.times_s.empty() || scan.times_s.size() != scan.points->size()) return {};
    const auto beams = beamsOf(scan);
    double rate = rateOf(beams);
    constexpr double kSlowest = 2 * M_PI, kFastest = 200 * M_PI;
    if (!(std::abs(rate) > kSlowest && std::abs(rate) < kFastest)) return {};
    for (int i = 0; i < 3; ++i) rate += slopeOf(beams, deviations(beams, rate));
    auto off = deviations(beams, rate);
    for (double& deviation : off) deviation = std::abs(deviation);
    // A packet's block has one time for 0.4 deg of turning; what does not turn is far off.
    constexpr double kMoved = 0.5 * M_PI / 180, kNoTurn = 20 * M_PI / 180;
    const double most = quantile(off, 0.95);
    if (most > kNoTurn) return {};
    return most > kMoved;
}
}  // namespace delio::io
