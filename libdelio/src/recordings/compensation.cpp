#include "compensation.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "odometry/rings.h"

namespace delio::io {
namespace {
struct Beam {
    double time_s, azimuth, range;
    std::uint16_t ring;
};

double turned(double angle) { return std::remainder(angle, 2 * M_PI); }

/** Points that are near enough for motion to show, and far enough that where a beam leaves the
 *  sensor does not; their indices. */
std::vector<std::size_t> usefulOf(const Scan& scan) {
    const auto& x = scan.points->getPointsBufferRef_x();
    const auto& y = scan.points->getPointsBufferRef_y();
    const auto& z = scan.points->getPointsBufferRef_z();
    constexpr float kNear = 2, kFar = 30;
    std::vector<std::size_t> useful;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const float range = std::hypot(x[i], y[i]);
        if (range > kNear && range < kFar && std::isfinite(z[i]) && std::isfinite(scan.times_s[i]))
            useful.push_back(i);
    }
    return useful;
}

std::vector<Beam> beamsOf(const Scan& scan) {
    const auto& x = scan.points->getPointsBufferRef_x();
    const auto& y = scan.points->getPointsBufferRef_y();
    const auto& z = scan.points->getPointsBufferRef_z();
    const auto useful = usefulOf(scan);
    std::vector<std::uint16_t> rings;
    if (scan.rings.empty()) {
        Eigen::Matrix3Xf points(3, static_cast<Eigen::Index>(useful.size()));
        for (std::size_t k = 0; k < useful.size(); ++k)
            points.col(static_cast<Eigen::Index>(k)) << x[useful[k]], y[useful[k]], z[useful[k]];
        rings = odometry::ringsOf(points);
    } else {
        for (const std::size_t i : useful) rings.push_back(scan.rings[i]);
    }
    std::vector<Beam> beams;
    for (std::size_t k = 0; k < useful.size(); ++k) {
        const std::size_t i = useful[k];
        beams.push_back(
            {scan.times_s[i], std::atan2(y[i], x[i]), std::hypot(x[i], y[i]), rings[k]});
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

/** Radians a second from points that follow each other; 0 where they do not show it. */
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

/** Deviation of each beam's azimuth from uniform rotation, minus the ring's median. */
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

/** Residual rate, by least squares. */
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
/** Quantile `share` of the deviations, rad, after removing one uniform motion of the sensor. */
double leftByMotion(const std::vector<Beam>& beams, const std::vector<double>& deviations,
                    double share) {
    constexpr int kUnknowns = 6;
    const auto count = static_cast<Eigen::Index>(beams.size());
    Eigen::Matrix<double, Eigen::Dynamic, kUnknowns> model(count, kUnknowns);
    Eigen::VectorXd left(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const Beam& beam = beams[static_cast<std::size_t>(i)];
        constexpr double kTurn_s = 0.1;  // all columns are of one size
        const double time = beam.time_s / kTurn_s, across = time / beam.range;
        model.row(i) << -std::sin(beam.azimuth) * across, std::cos(beam.azimuth) * across, 1, time,
            time * time, time * time * time;
        left[i] = deviations[static_cast<std::size_t>(i)];
    }
    const Eigen::Matrix<double, kUnknowns, kUnknowns> square = model.transpose() * model;
    const Eigen::Matrix<double, kUnknowns, 1> motion =
        square.ldlt().solve(model.transpose() * left);
    left = (left - model * motion).cwiseAbs();
    return quantile(std::vector<double>(left.data(), left.data() + count), share);
}
}  // namespace

std::optional<bool> isMotionCompensated(const Scan& scan) {
    if (scan.times_s.empty() || scan.times_s.size() != scan.points->size()) return {};
    const auto beams = beamsOf(scan);
    double rate = rateOf(beams);
    constexpr double kSlowest = 2 * M_PI, kFastest = 200 * M_PI;
    if (!(std::abs(rate) > kSlowest && std::abs(rate) < kFastest)) return {};
    for (int i = 0; i < 3; ++i) rate += slopeOf(beams, deviations(beams, rate));
    const auto off = deviations(beams, rate);
    auto sizes = off;
    for (double& size : sizes) size = std::abs(size);
    // A packet's block has one time for 0.4 deg of turning; what does not turn is far off.
    constexpr double kMoved = 0.5 * M_PI / 180, kNoTurn = 20 * M_PI / 180, kShare = 0.95;
    const double most = quantile(sizes, kShare);
    if (most > kNoTurn) return {};
    if (most <= kMoved) return false;
    // Times of packets that are not those of the lasers, or rings that mix lasers, are no motion.
    constexpr double kExplained = 0.7;
    if (leftByMotion(beams, off, kShare) > kExplained * most) return {};
    return true;
}

bool timesFitDirections(const Scan& scan) {
    const auto& x = scan.points->getPointsBufferRef_x();
    const auto& y = scan.points->getPointsBufferRef_y();
    const auto& z = scan.points->getPointsBufferRef_z();
    const auto directionOf = [&](std::size_t i) {
        return Eigen::Vector3f(x[i], y[i], z[i]).normalized();
    };
    constexpr std::size_t kPairs = 2000, kFewest = 100;
    constexpr float kNear = 0.996F;  // cosine of 5 deg: rings are up to 2 deg apart
    std::vector<float> gaps_s, times_s;
    for (std::size_t i = 0; i + 1 < scan.times_s.size(); i += 1 + x.size() / kPairs) {
        const float gap_s = std::abs(scan.times_s[i + 1] - scan.times_s[i]);
        // NaN: a point without return, or without time.
        if (!(directionOf(i).dot(directionOf(i + 1)) > kNear) || !std::isfinite(gap_s)) continue;
        gaps_s.push_back(gap_s);
        times_s.push_back(scan.times_s[i]);
    }
    if (gaps_s.size() < kFewest) return true;
    constexpr float kMost = 0.1F;  // of the sweep; unrelated times are a third of it apart
    const float sweep_s = quantile(times_s, 0.95) - quantile(times_s, 0.05);
    return quantile(gaps_s, 0.5) <= kMost * sweep_s;
}
}  // namespace delio::io
