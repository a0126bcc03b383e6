#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "carrier.h"
#include "handheld.h"
#include "motion.h"
#include "road.h"
#include "start.h"

namespace delio::synth {
constexpr double kScanPeriod_s = 0.1;

/** Where the vehicle is at every scan: it moves as the road's style or a given trajectory has it,
 *  and pitches and rolls with the ground under its wheels. A sensor in a hand moves at walking
 *  speed, if no trajectory says otherwise, and swings. `start` is for what no trajectory says. */
class Drive {
 public:
    /** Fewer scans than requested if the given trajectory ends earlier. */
    Drive(const Road& road, std::size_t scans, std::uint64_t seed, Gait gait = Gait::kVehicle,
          Start start = Start::kOfSeed);

    std::size_t scans() const { return scans_; }
    /** Metres along the path at scan `scan`. */
    double station(std::size_t scan) const { return stationAt(timeOf(scan)); }
    /** The same at any time, seconds from scan 0. */
    double stationAt(double time_s) const { return motion_->at(time_s).s; }
    /** LiDAR to world: x forward, y left, z up. */
    Eigen::Isometry3d lidarPose(std::size_t scan) const { return lidarPoseAt(timeOf(scan)); }
    Eigen::Isometry3d lidarPoseAt(double time_s) const;
    const Carrier& carrier() const { return carrier_; }

    /** From here on as if the road were driven the other way, in the other lane, from where this
     *  drive ends. */
    void turnBack();

 private:
    static double timeOf(std::size_t scan) { return kScanPeriod_s * static_cast<double>(scan); }

    Eigen::Isometry3d steadyPoseAt(double time_s) const;

    const Road& road_;
    Carrier carrier_;
    std::optional<Handheld> hand_;
    std::shared_ptr<const Motion> own_;  //!< where none is given
    const Motion* motion_;
    std::size_t scans_;
};
}  // namespace delio::synth
