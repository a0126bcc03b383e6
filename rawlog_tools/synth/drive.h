#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "road.h"

namespace delio::synth {
constexpr double kScanPeriod_s = 0.1;
constexpr double kMaxSpeed_m_s = 12;

/** Where the vehicle is at every scan: it starts from standstill, slows down for turns, and
 *  pitches and rolls with the road under its wheels. */
class Drive {
 public:
    static constexpr double kSensorHeight_m = 1.73;

    Drive(const Road& road, std::size_t scans, std::uint64_t seed);

    std::size_t scans() const { return s_.size(); }
    /** Metres along the path at scan `scan`. */
    double station(std::size_t scan) const { return s_[scan]; }
    /** The same at any time, seconds from scan 0: before the first scan the vehicle stands, and it
     *  drives on after the last. */
    double stationAt(double time_s) const;
    /** LiDAR to world: x forward, y left, z up. */
    Eigen::Isometry3d lidarPose(std::size_t scan) const;
    Eigen::Isometry3d lidarPoseAt(double time_s) const;

 private:
    /** A stretch of constant acceleration. */
    struct Leg {
        double begin_s;  //!< time
        double station, speed, acceleration;
    };
    const Road& road_;
    std::vector<Leg> legs_;
    std::vector<double> s_;
};
}  // namespace delio::synth
