#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "road_profile.h"

namespace delio::synth {
/** The land that roads are laid on: functions of the place alone, so that a place has one height
 *  however often one comes there. */
class Terrain {
 public:
    Terrain(const RoadProfile& profile, std::uint64_t seed);

    /** Hills, floors, and the unevenness of what is built on them. */
    double height(const Eigen::Vector2d& place) const;
    /** Height added at `away_m` from a road: banks, and roughness at the scale of a decimetre. */
    double besideRoad(const Eigen::Vector2d& place, double away_m) const;

 private:
    struct Wave {
        double amplitude;
        Eigen::Vector2d number;
        double phase;
    };
    double roughness(const Eigen::Vector2d& place) const;

    std::uint64_t seed_;
    double grade_, half_m_, bank_m_, bankFrom_m_, bankTo_m_, roughness_m_;
    std::vector<Wave> waves_, banks_;
    std::vector<RoadProfile::Ramp> ramps_;
};
}  // namespace delio::synth
