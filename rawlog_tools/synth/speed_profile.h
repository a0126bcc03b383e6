#pragma once
#include <cstdint>
#include <vector>

#include "motion.h"
#include "path.h"
#include "road_profile.h"

namespace delio::synth {
/** Drives along a path as its curves, the engine and the brakes allow, with stops of some seconds.
 *  What comes late in the drive does not change how it begins. */
class SpeedProfile : public Motion {
 public:
    SpeedProfile(const Path& path, const DrivingStyle& style, std::uint64_t seed);
    PlanPose at(double time_s) const override;
    double duration_s() const override { return end_s_; }

 private:
    /** A stretch of constant acceleration; a stop is one of length 0. */
    struct Leg {
        double begin_s;  //!< time
        double station, speed, acceleration;
    };
    double stationAt(double time_s) const;

    const Path& path_;
    std::vector<Leg> legs_;
    double end_s_ = 0;
};
}  // namespace delio::synth
