#include "delio/odometry/step.h"

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
}  // namespace delio
