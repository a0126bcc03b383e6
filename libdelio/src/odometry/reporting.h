#pragma once
#include <string_view>
#include <vector>

#include "core/estimates.h"
#include "delio/core/stopwatch.h"
#include "delio/odometry/step.h"

namespace delio::odometry {
/** The quality of the registration that gave both estimates. */
Quality qualityOf(const RotationEstimate& rotation, const TranslationEstimate& translation);

/** Zero for each stage: every step has the same stages, whether the scan went through them or not.
 */
std::vector<Named> noTimes();

/** Adds the time of its own life to that of a stage in Step::times_ms. */
class StageTimer {
 public:
    /** Begins. `step` and `stage` outlive it. */
    StageTimer(Step& step, std::string_view stage) : step_(step), stage_(stage) {}
    ~StageTimer();
    StageTimer(const StageTimer&) = delete;
    StageTimer& operator=(const StageTimer&) = delete;

 private:
    Step& step_;
    std::string_view stage_;
    Stopwatch watch_;
};
}  // namespace delio::odometry
