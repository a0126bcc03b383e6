#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>

#include "road_profile.h"

namespace delio::synth {
/** How the sensor is moved along its way. */
enum class Gait {
    kVehicle,  //!< on wheels, indoors in hands as steady as those
    kHandheld  //!< hand-held by a walking person: swings in six degrees of freedom
};

/** Nobody walks faster than `kFastestWalk_m_s`; what is slower stays as it is. */
DrivingStyle walking(DrivingStyle style);
constexpr double kFastestWalk_m_s = 1.3;

/** The swings of a hand that walks: a sine in each degree of freedom, with amplitude, frequency and
 *  phase of its own, so that no two drives swing alike. A closed formula of time. */
class Handheld {
 public:
    static constexpr double kSwing_deg = 15, kSwing_Hz = 1.5;

    explicit Handheld(std::uint64_t seed);
    /** Maps the swinging sensor's coordinates to those of one that is held still. */
    Eigen::Isometry3d at(double time_s) const;

 private:
    struct Sine {
        double amplitude, frequency_Hz, phase;
        double at(double time_s) const;
    };
    static Sine sine(double amplitude, double frequency_Hz, std::uint64_t seed, std::uint64_t axis);

    std::array<Sine, 3> turns_;   //!< yaw, pitch, roll; radians
    std::array<Sine, 3> shifts_;  //!< x, y, z; metres
};
}  // namespace delio::synth
