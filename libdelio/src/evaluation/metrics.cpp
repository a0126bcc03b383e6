#include "delio/evaluation/metrics.h"

#include <mrpt/core/bits_math.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/percentile.h"
#include "core/portable_math.h"

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

Eigen::Matrix3Xd positions(const std::vector<Eigen::Isometry3d>& poses) {
    Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(poses.size()));
    for (std::size_t i = 0; i < poses.size(); ++i)
        result.col(static_cast<Eigen::Index>(i)) = poses[i].translation();
    return result;
}
}  // namespace

double rotationAngle_rad(const Eigen::Isometry3d& pose) {
    const Eigen::Matrix3d nearly = pose.linear();
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(nearly, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix3d R = svd.matrixU() * svd.matrixV().transpose();
    const Eigen::Vector3d skew(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
    return portable::atan2(skew.norm(), R.trace() - 1);  // 2 sin, 2 cos
}

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

AbsoluteError absoluteError(const std::vector<Eigen::Isometry3d>& reference,
                            const std::vector<Eigen::Isometry3d>& estimate) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    if (reference.empty()) return {none, none};
    const Eigen::Matrix3Xd wanted = positions(reference);
    const Eigen::Matrix3Xd found = positions(estimate);
    const Eigen::Isometry3d align(Eigen::umeyama(found, wanted, false));
    const Eigen::RowVectorXd squares = (align * found - wanted).colwise().squaredNorm();
    return {std::sqrt(squares.mean()), std::sqrt(squares.maxCoeff())};
}

Spread spreadOf(std::vector<double> errors) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    if (errors.empty()) return {none, none, none, none};
    std::sort(errors.begin(), errors.end());
    const std::size_t n = errors.size();
    double squares = 0;
    for (const double e : errors) squares += e * e;
    Spread spread;
    spread.rmse = std::sqrt(squares / static_cast<double>(n));
    spread.median = (errors[(n - 1) / 2] + errors[n / 2]) / 2;
    spread.p95 = percentileOf(errors, 95);
    spread.max = errors.back();
    return spread;
}

PoseError poseError(const std::vector<Eigen::Isometry3d>& reference,
                    const std::vector<Eigen::Isometry3d>& estimate) {
    std::vector<double> translations_m, rotations_deg;
    for (std::size_t i = 0; i < reference.size(); ++i) {
        const Eigen::Isometry3d error = estimate[i].inverse() * reference[i];
        translations_m.push_back(error.translation().norm());
        rotations_deg.push_back(mrpt::RAD2DEG(rotationAngle_rad(error)));
    }
    return {spreadOf(std::move(translations_m)), spreadOf(std::move(rotations_deg))};
}

RelativeError relativeError(const std::vector<Eigen::Isometry3d>& reference,
                            const std::vector<Eigen::Isometry3d>& estimate, std::size_t delta) {
    RelativeError result;
    for (std::size_t i = 0; i + delta < reference.size(); ++i) {
        const Eigen::Isometry3d wanted = reference[i].inverse() * reference[i + delta];
        const Eigen::Isometry3d found = estimate[i].inverse() * estimate[i + delta];
        const Eigen::Isometry3d error = found.inverse() * wanted;
        result.translations_m.push_back(error.translation().norm());
        result.rotations_deg.push_back(mrpt::RAD2DEG(rotationAngle_rad(error)));
    }
    result.translation_m = spreadOf(result.translations_m);
    result.rotation_deg = spreadOf(result.rotations_deg);
    return result;
}
}  // namespace delio::evaluation
