#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace delio {
/** One pose by the wheels, or by any other odometry of the vehicle. */
struct OdometrySample {
    double stamp_s = 0;  //!< seconds, of the clock of Scan::stamp_s
    /** Maps the odometry's moving frame to its fixed one, metres. It may drift. */
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    /** Pose of the odometry's moving frame in the vehicle: maps its coordinates to the vehicle's;
     *  nothing where the source does not say it: the moving frame is the vehicle's. */
    std::optional<Eigen::Isometry3d> sensorPose;
};

/** What a LiDAR odometry found out about the wheels. */
struct OdometryReport {
    std::size_t samples = 0;        //!< that were used
    std::size_t dropped = 0;        //!< not finite, or not later than the one before
    std::size_t jumps = 0;          //!< between two samples, faster than a vehicle moves
    std::size_t scans = 0;          //!< that came after the first sample
    std::size_t scansWithout = 0;   //!< for which samples were missing
    std::size_t scansCarried = 0;   //!< whose translation along an unobserved axis is the wheels'
    std::size_t compared = 0;       //!< stretches of 2 m or more on which the scans saw all axes
    std::size_t contradicting = 0;  //!< of these, where the wheels differ from the scans
    double scale = 1;               //!< the wheels' distances times this are those of the scans
    /** Standard deviation of the scaled distances from those of the scans, as a part of the way;
     *  nothing: there were too few stretches to know it. */
    std::optional<double> sigma;
    /** Why the wheels were not or not always used, a line each. */
    std::vector<std::string> findings;
};
}  // namespace delio
