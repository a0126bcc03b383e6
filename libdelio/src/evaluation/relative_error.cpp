#include "delio/evaluation/relative_error.h"

#include <mrpt/core/bits_math.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/percentile.h"
#include "delio/evaluation/rotation_angle.h"

namespace delio::evaluation {
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
