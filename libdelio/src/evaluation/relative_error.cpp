#include "delio/evaluation/relative_error.h"

#include <mrpt/core/bits_math.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "delio/evaluation/rotation_angle.h"

namespace delio::evaluation {
using mrpt::poses::CPose3D;

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
    spread.p95 = errors[(95 * n + 99) / 100 - 1];
    spread.max = errors.back();
    return spread;
}

RelativeError relativeError(const std::vector<CPose3D>& reference,
                            const std::vector<CPose3D>& estimate, std::size_t delta) {
    RelativeError result;
    for (std::size_t i = 0; i + delta < reference.size(); ++i) {
        const CPose3D error =
            (reference[i + delta] - reference[i]) - (estimate[i + delta] - estimate[i]);
        result.translations_m.push_back(error.norm());
        result.rotations_deg.push_back(mrpt::RAD2DEG(rotationAngle_rad(error)));
    }
    result.translation_m = spreadOf(result.translations_m);
    result.rotation_deg = spreadOf(result.rotations_deg);
    return result;
}
}  // namespace delio::evaluation
