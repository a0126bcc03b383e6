#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "path.h"

namespace delio::synth {
/** One that vehicles drive on. */
struct Lane {
    double side_m;     //!< its middle, from the road's centre line
    int direction;     //!< +1: with the vehicle, -1: against it
    double speed_m_s;  //!< of traffic that flows freely
};

/** The ground around the vehicle's path: a two-lane road with parking strips, kerbs and sidewalks
 *  in rolling terrain. Sideways places are measured from the road's centre line, positive to the
 *  left; the vehicle keeps right of it. */
class Road {
 public:
    static constexpr double kVehicleOffset_m = -1.6;
    static constexpr double kLaneEdge_m = 3.3;     //!< parked cars stay outside
    static constexpr double kKerb_m = 5.5;         //!< all else stays outside
    static constexpr double kSidewalkEnd_m = 8.7;  //!< facades stay outside

    Road(Path path, std::uint64_t seed);

    const Path& path() const { return path_; }
    /** The vehicle's own is the first. */
    std::vector<Lane> lanes() const { return {{kVehicleOffset_m, 1, 10}, {1.6, -1, 10}}; }
    /** Seen from above, at `side_m` from the centre line. */
    Eigen::Vector2d point(double s, double side_m) const;
    /** Distance from the centre line within some 200 m before and behind `s`. */
    double distance(const Eigen::Vector2d& place, double s) const;
    /** Height of the ground at `place`, `side_m` away from the centre line. */
    double height(const Eigen::Vector2d& place, double side_m) const;
    /** The same, on the sidewalk or beyond it. */
    double height(const Eigen::Vector2d& place) const { return height(place, kSidewalkEnd_m); }

 private:
    struct Wave {
        double amplitude;
        Eigen::Vector2d number;
        double phase;
    };
    Path path_;
    std::array<Wave, 8> waves_;
};
}  // namespace delio::synth
