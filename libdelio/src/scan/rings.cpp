#include "delio/scan/rings.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "beams.h"

namespace delio::scan {
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
        // many is enough to tell that these are none.
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
    constexpr double kLargestDeviation = 1.0 * M_PI / 180;
    return deviation < kLargestDeviation * static_cast<double>(rings.size());
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
}  // namespace delio::scan
