#pragma once
#include <mrpt/core/Clock.h>
#include <mrpt/maps/CPointsMap.h>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace delio {
/** One LiDAR observation as its source gives it: nothing corrected, nothing dropped.
 *
 *  `points` is mandatory. `rings` and `times_s` are optional: they are empty, or hold one value for
 *  each point. `stamp_s` has to increase from scan to scan; it is what the motion model measures
 *  time by. `index` is only used in messages and results. requireConsistent() checks this. */
struct Scan {
    std::size_t index = 0;  //!< counts the observations of the chosen label, from 0
    double stamp_s = 0;     //!< seconds, as in times.txt (Unix seconds where there is no times.txt)
    mrpt::Clock::time_point time;  //!< the same as MRPT's clock has it

    /** Mandatory, but may hold no points. Metres, in the sensor's frame (x forward, y left, z up),
     *  in the order of the sensor. NaN points may be among them. A CPointsMapXYZI where the source
     *  has intensities. */
    mrpt::maps::CPointsMap::Ptr points;

    /** Ring (laser) of each point, in the order of `points`; empty if the source does not give
     *  rings. */
    std::vector<std::uint16_t> rings;

    /** Time of each point, in the order of `points`, in seconds from the stamp (negative: before
     *  it); empty if the source does not give times. A point of NaN or of more than a second from
     *  the stamp is not used. */
    std::vector<float> times_s;

    /** Scans since the one before that were dropped for lack of time (ScanFeed). An odometry then
     *  leaves out searches that would cost it more scans than they are worth. */
    std::size_t dropped = 0;

    /** Pose of the sensor in the vehicle: maps sensor coordinates to vehicle coordinates. */
    Eigen::Isometry3d sensorPose = Eigen::Isometry3d::Identity();
};

/** Throws Error, which names the scan, the field and the sizes, if `points` is null, `rings` or
 *  `times_s` has values but not one for each point, or `sensorPose` is not finite. Every odometry
 *  calls it before it reads the scan, and so does Slam. */
void requireConsistent(const Scan& scan);

/** The size of the place that a scan shows, 1 for streets and less for rooms: nine points in ten
 *  are within 16 m times this. 0.25 to 1. */
double scaleOf(const Scan& scan);
}  // namespace delio
