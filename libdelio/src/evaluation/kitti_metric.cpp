#include "delio/evaluation/kitti_metric.h"

#include <mrpt/core/bits_math.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "delio/evaluation/rotation_angle.h"

namespace delio::evaluation {
namespace {
constexpr std::size_t kStep = 10;  // KITTI's: one second of its drives

/** All segments of one length. */
std::vector<Segment> segmentsOf(const std::vector<Eigen::Isometry3d>& reference,
                                const std::vector<Eigen::Isometry3d>& estimate,
                                const std::vector<double>& travelled, double length) {
    std::vector<Segment> segments;
    for (std::size_t first = 0; first < travelled.size(); first += kStep) {
        const auto beyond =
            std::upper_bound(travelled.begin(), travelled.end(), travelled[first] + length);
        if (beyond == travelled.end()) break;  // nor is there one for any later start
        const auto last = static_cast<std::size_t>(beyond - travelled.begin());
        const Eigen::Isometry3d wanted = reference[first].inverse() * reference[last];
        const Eigen::Isometry3d found = estimate[first].inverse() * estimate[last];
        const Eigen::Isometry3d error = found.inverse() * wanted;
        segments.push_back({first, last, length, 100 * error.translation().norm() / length,
                            100 * mrpt::RAD2DEG(rotationAngle_rad(error)) / length});
    }
    return segments;
}
}  // namespace

SegmentErrors meanOf(const std::vector<Segment>& segments) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    if (segments.empty()) return {0, none, none};
    SegmentErrors mean;
    mean.segments = segments.size();
    for (const auto& segment : segments) {
        mean.t_percent += segment.t_percent;
        mean.r_deg_per_100m += segment.r_deg_per_100m;
    }
    mean.t_percent /= static_cast<double>(segments.size());
    mean.r_deg_per_100m /= static_cast<double>(segments.size());
    return mean;
}

std::vector<double> travelled_m(const std::vector<Eigen::Isometry3d>& poses) {
    std::vector<double> result;
    double sum = 0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        if (i > 0) sum += (poses[i].translation() - poses[i - 1].translation()).norm();
        result.push_back(sum);
    }
    return result;
}

std::vector<double> kittiLengths_m() { return {100, 200, 300, 400, 500, 600, 700, 800}; }

double pathLength_m(const std::vector<Eigen::Isometry3d>& poses) {
    return poses.empty() ? 0 : travelled_m(poses).back();
}

std::vector<double> suggestedLengths_m(double path_m) {
    if (path_m < 0.1) return {};
    // The greatest 1, 2 or 5 times a power of ten of which the path has eight.
    const double eighth = path_m / 8;
    const double power = std::pow(10, std::floor(std::log10(eighth)));
    const double unit = power * (eighth >= 5 * power ? 5 : eighth >= 2 * power ? 2 : 1);
    return {unit, 2 * unit, 3 * unit, 4 * unit};
}

KittiErrors kittiErrors(const std::vector<Eigen::Isometry3d>& reference,
                        const std::vector<Eigen::Isometry3d>& estimate,
                        const std::vector<double>& lengths_m) {
    const auto travelled = travelled_m(reference);
    KittiErrors result;
    for (const double length : lengths_m) {
        const auto segments = segmentsOf(reference, estimate, travelled, length);
        result.all.insert(result.all.end(), segments.begin(), segments.end());
        result.perLength.push_back({meanOf(segments), length});
    }
    static_cast<SegmentErrors&>(result) = meanOf(result.all);
    return result;
}
}  // namespace delio::evaluation
