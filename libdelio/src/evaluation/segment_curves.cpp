#include "delio/evaluation/segment_curves.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace delio::evaluation {
namespace {
constexpr std::size_t kFewest = 3;    // segments that make a point
constexpr double kSpeedStep_mps = 2;  // between points, and half of what one covers
constexpr double kTooFast_mps = 2e3;  // stamps that nearly coincide

void append(std::vector<CurvePoint>& curve, double at, const std::vector<Segment>& segments) {
    if (segments.size() < kFewest) return;
    const auto mean = meanOf(segments);
    curve.push_back({at, mean.t_percent, mean.r_deg_per_100m});
}
}  // namespace

std::vector<CurvePoint> errorOverLength(const std::vector<const Comparison*>& sequences) {
    std::map<double, std::vector<Segment>> byLength;
    for (const auto* sequence : sequences)
        for (const auto& segment : sequence->row.kitti.all)
            byLength[segment.length_m].push_back(segment);
    std::vector<CurvePoint> curve;
    for (const auto& [length, segments] : byLength) append(curve, length, segments);
    return curve;
}

std::vector<CurvePoint> errorOverSpeed(const std::vector<const Comparison*>& sequences) {
    std::map<int, std::vector<Segment>> bySpeed;  // of the points, counted from 1
    for (const auto* sequence : sequences)
        for (const auto& segment : sequence->row.kitti.all) {
            const double duration =
                sequence->times_s[segment.last] - sequence->times_s[segment.first];
            if (segment.length_m >= kTooFast_mps * duration) continue;
            const double place = segment.length_m / duration / kSpeedStep_mps;
            // The points less than one step away: one below, one above, or just its own.
            for (int k = std::max(1, static_cast<int>(std::floor(place))); k < place + 1; ++k)
                if (std::abs(k - place) < 1) bySpeed[k].push_back(segment);
        }
    std::vector<CurvePoint> curve;
    for (const auto& [k, segments] : bySpeed) append(curve, 3.6 * kSpeedStep_mps * k, segments);
    return curve;
}
}  // namespace delio::evaluation
