#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>

#include "delio/odometry/wheels.h"
#include "drive.h"

namespace delio::synth {
/** Wheel odometry and its errors. */
struct WheelModel {
    double scaleError = 0;  //!< part by which its distances are too long
    /** From `slipFirst_s` to `slipLast_s` they are longer by this part, too: the wheels slip. */
    double slip = 0, slipFirst_s = 0, slipLast_s = 0;
};

/** Poses in the plane by the wheels of a drive, from 0.1 s before its first scan on, in the frame
 *  of the upright LiDAR. */
class Wheels {
 public:
    Wheels(const WheelModel& model, const Drive& drive, std::uint64_t seed)
        : model_(model), drive_(drive), seed_(seed) {}

    /** The next sample, if it is stamped no later than `stamp_s`. */
    std::optional<OdometrySample> next(double stamp_s);

 private:
    WheelModel model_;
    const Drive& drive_;
    std::uint64_t seed_;
    double x_m_ = 0, y_m_ = 0, yaw_rad_ = 0;
    std::size_t samples_ = 0;
};
}  // namespace delio::synth
