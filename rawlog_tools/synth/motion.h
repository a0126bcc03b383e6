#pragma once

namespace delio::synth {
/** Position seen from above, and distance along the path. */
struct PlanPose {
    double s = 0, x = 0, y = 0, yaw = 0;
};

/** The vehicle's way through time. */
class Motion {
 public:
    virtual ~Motion() = default;
    /** `time_s`: from scan 0; a little before it and after the end, too. */
    virtual PlanPose at(double time_s) const = 0;
    /** Until when it is known. */
    virtual double duration_s() const = 0;
};
}  // namespace delio::synth
