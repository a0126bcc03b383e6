#include "delio/odometry/step.h"

#include <algorithm>

namespace delio {
Quality qualityOf(const RotationEstimate& rotation, const TranslationEstimate& translation) {
    Quality quality;
    quality.matches = translation.matches;
    quality.residual_m = translation.residual_m;
    quality.rotationObservability = rotation.observability;
    quality.translationObservability = translation.observability;
    quality.unobservedRotation = rotation.unobservedAxes;
    quality.unobservedTranslation = rotation.rotation.transpose() * translation.unobservedAxes;
    return quality;
}

double& timeOf(Step& step, std::string_view stage) {
    return std::find_if(step.times_ms.begin(), step.times_ms.end(),
                        [&](const Named& time) { return time.first == stage; })
        ->second;
}
}  // namespace delio
