#include "odometry/rings.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <utility>

namespace delio::odometry {
namespace {
constexpr double kDegree = M_PI / 180;
constexpr double kBin = 0.02 * kDegree;
constexpr std::size_t kBins = 9000;  // half a turn
constexpr std::size_t kMostBeams = 256;

/** A few modes of anything have little blur, far from each other as they are. */
constexpr double kLargestDeviation = 0.5 * kDegree;

using Histogram = std::vector<double>;

Histogram histogramOf(const Eigen::Matrix3Xf& points, float height) {
    Histogram counts(kBins, 0);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const double turn = static_cast<double>(elevationFrom(height, points.col(i))) + M_PI / 2;
        counts[std::min(kBins - 1, static_cast<std::size_t>(std::max(turn, 0.0) / kBin))] += 1;
    }
    return counts;
}

/** Sums over 2 `reach` + 1 bins. */
Histogram summed(const Histogram& counts, std::size_t reach) {
    Histogram before(counts.size() + 1, 0);
    std::partial_sum(counts.begin(), counts.end(), before.begin() + 1);
    Histogram sums(counts.size());
    for (std::size_t i = 0; i < counts.size(); ++i)
        sums[i] = before[std::min(i + reach + 1, counts.size())] - before[i - std::min(i, reach)];
    return sums;
}

/** Whether two counts differ by more than chance, and much. */
bool above(double high, double low) {
    return low < 0.6 * high && high - low > 3 * std::sqrt(high + low);
}

/** Where the counts within `reach` rise and fall again, as centroids of those counts; bins. */
std::vector<double> modesOf(const Histogram& counts, std::size_t reach) {
    Histogram density = summed(summed(counts, reach), reach);  // weights: a triangle
    for (auto& d : density) d /= static_cast<double>(2 * reach + 1);
    std::vector<double> modes;
    const auto add = [&](std::size_t peak) {
        double sum = 0, moment = 0;
        const std::size_t end = std::min(peak + reach + 1, kBins);
        for (std::size_t i = peak - std::min(peak, reach); i < end; ++i) {
            sum += counts[i];
            moment += counts[i] * static_cast<double>(i);
        }
        modes.push_back(sum > 0 ? moment / sum : static_cast<double>(peak));
    };
    bool rises = true;
    std::size_t extreme = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
        const double high = rises ? density[extreme] : density[i];
        const double low = rises ? density[i] : density[extreme];
        if (low > high) extreme = i;
        if (!above(high, low)) continue;
        if (rises) add(extreme);
        rises = !rises;
        extreme = i;
    }
    return modes;
}

/** Blur and deviation. */
std::pair<double, double> fitOf(const Histogram& counts, const std::vector<double>& modes) {
    if (modes.empty()) return {1, M_PI};
    double sum = 0, blur = 0, deviation = 0;
    std::size_t next = 0;  // the first mode above the bin
    for (std::size_t i = 0; i < kBins; ++i) {
        const auto at = static_cast<double>(i);
        while (next < modes.size() && modes[next] <= at) ++next;
        if (counts[i] == 0) continue;
        const std::size_t upper =
            std::clamp<std::size_t>(next, 1, std::max<std::size_t>(modes.size() - 1, 1));
        const double gap = modes.size() > 1 ? modes[upper] - modes[upper - 1] : kDegree / kBin;
        double distance = kBins;
        if (next > 0) distance = std::min(distance, at - modes[next - 1]);
        if (next < modes.size()) distance = std::min(distance, modes[next] - at);
        sum += counts[i];
        blur += counts[i] * std::min(distance / gap, 1.0);
        deviation += counts[i] * distance * kBin;
    }
    return {blur / std::max(sum, 1.0), deviation / std::max(sum, 1.0)};
}
}  // namespace

float elevationFrom(float height, const Eigen::Vector3f& point) {
    return std::atan2(point.z() - height, point.head<2>().norm());
}

Beams beamsFrom(const Eigen::Matrix3Xf& points, float height) {
    const Histogram counts = histogramOf(points, height);
    Beams best;
    best.height = height;
    // Wide enough for the noise, but not so wide that neighbours become one: what blurs least.
    for (const std::size_t reach : {1, 2, 4, 8, 16}) {
        const auto modes = modesOf(counts, reach);
        const auto [blur, deviation] = fitOf(counts, modes);
        if (blur >= best.blur || modes.size() > kMostBeams || deviation > kLargestDeviation)
            continue;
        best.blur = blur;
        best.elevations.clear();
        for (auto mode = modes.rbegin(); mode != modes.rend(); ++mode)
            best.elevations.push_back(static_cast<float>((*mode + 0.5) * kBin - M_PI / 2));
    }
    return best;
}

Beams beamsFromAnyHeight(const Eigen::Matrix3Xf& points) {
    constexpr int kSteps = 15;
    constexpr float kStep = 0.02F;
    Beams best;
    for (int step = -kSteps; step <= kSteps; ++step) {
        Beams beams = beamsFrom(points, static_cast<float>(step) * kStep);
        if (beams.blur < best.blur) best = std::move(beams);
    }
    return best;
}

std::vector<std::uint16_t> nearestBeams(const Eigen::Matrix3Xf& points, const Beams& beams) {
    std::vector<float> borders;  // falling
    for (std::size_t i = 1; i < beams.elevations.size(); ++i)
        borders.push_back((beams.elevations[i - 1] + beams.elevations[i]) / 2);
    std::vector<std::uint16_t> nearest;
    nearest.reserve(static_cast<std::size_t>(points.cols()));
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const float elevation = elevationFrom(beams.height, points.col(i));
        const auto border =
            std::lower_bound(borders.begin(), borders.end(), elevation, std::greater<>());
        nearest.push_back(static_cast<std::uint16_t>(border - borders.begin()));
    }
    return nearest;
}

namespace {
constexpr std::size_t kMostRings = 256;
constexpr int kElevationSteps = 64;

/** With less blur than that every point is taken to lie next to its own beam. */
constexpr double kSharp = 0.05;
/** With more, points at random are as likely as beams. Of a normal distribution so wide, 1 % lies
 *  nearer to another beam. */
constexpr double kMostBlur = 0.2;

float elevationOf(const Eigen::Vector3f& p) { return elevationFrom(0, p); }

std::vector<std::uint16_t> ringsByOrder(const Eigen::Matrix3Xf& points) {
    std::vector<std::uint16_t> rings;
    rings.reserve(static_cast<std::size_t>(points.cols()));
    std::uint16_t ring = 0;
    float before = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        float azimuth = std::atan2(points(1, i), points(0, i));
        if (azimuth < 0) azimuth += static_cast<float>(2 * M_PI);
        // Half a turn: a ring may turn either way, and noise at its seam is small. One ring too
        // many shows that these are no rings.
        if (i > 0 && std::abs(azimuth - before) > static_cast<float>(M_PI) && ring < kMostRings)
            ++ring;
        before = azimuth;
        rings.push_back(ring);
    }
    return rings;
}

/** True if each ring keeps to its elevation: the mean absolute deviation is small beside the whole
 *  field of view. */
bool areRings(const Eigen::Matrix3Xf& points, const std::vector<std::uint16_t>& rings) {
    const std::size_t count = rings.empty() ? 0 : rings.back() + 1U;
    if (count < 4 || count > kMostRings) return false;
    std::vector<double> sum(count, 0), size(count, 0);
    for (std::size_t i = 0; i < rings.size(); ++i) {
        sum[rings[i]] += elevationOf(points.col(static_cast<Eigen::Index>(i)));
        size[rings[i]] += 1;
    }
    double deviation = 0;
    for (std::size_t i = 0; i < rings.size(); ++i)
        deviation += std::abs(elevationOf(points.col(static_cast<Eigen::Index>(i))) -
                              sum[rings[i]] / size[rings[i]]);
    constexpr double kRingDeviation = 1.0 * M_PI / 180;
    return deviation < kRingDeviation * static_cast<double>(rings.size());
}

std::vector<std::uint16_t> equalSteps(const Eigen::Matrix3Xf& points) {
    std::vector<float> elevations;
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        elevations.push_back(elevationOf(points.col(i)));
    std::vector<std::uint16_t> rings;
    if (elevations.empty()) return rings;
    const auto [lowest, highest] = std::minmax_element(elevations.begin(), elevations.end());
    const float step = std::max((*highest - *lowest) / kElevationSteps, 1e-6F);
    for (const float elevation : elevations)
        rings.push_back(static_cast<std::uint16_t>(
            std::min(kElevationSteps - 1, static_cast<int>((*highest - elevation) / step))));
    return rings;
}
}  // namespace

std::vector<std::uint16_t> ringsFromTop(const Eigen::Matrix3Xf& points,
                                        const std::vector<std::uint16_t>& rings) {
    struct Mean {
        double sum = 0, count = 0;
    };
    std::map<std::uint16_t, Mean> means;
    for (std::size_t i = 0; i < rings.size(); ++i) {
        auto& mean = means[rings[i]];
        mean.sum += static_cast<double>(elevationOf(points.col(static_cast<Eigen::Index>(i))));
        mean.count += 1;
    }
    std::multimap<double, std::uint16_t, std::greater<>> fromTop;
    for (const auto& [ring, mean] : means) fromTop.emplace(mean.sum / mean.count, ring);
    std::map<std::uint16_t, std::uint16_t> numbers;
    for (const auto& [elevation, ring] : fromTop)
        numbers[ring] = static_cast<std::uint16_t>(numbers.size());
    std::vector<std::uint16_t> result;
    result.reserve(rings.size());
    for (const auto ring : rings) result.push_back(numbers[ring]);
    return result;
}

std::vector<std::uint16_t> ringsOf(const Eigen::Matrix3Xf& points) {
    auto beams = beamsFrom(points, 0);
    if (beams.blur <= kSharp) return nearestBeams(points, beams);
    auto rings = ringsByOrder(points);
    if (areRings(points, rings)) return rings;
    beams = beamsFromAnyHeight(points);
    return beams.blur <= kMostBlur ? nearestBeams(points, beams) : equalSteps(points);
}
}  // namespace delio::odometry
