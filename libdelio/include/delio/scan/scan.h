#pragma once
#include <mrpt/core/Clock.h>
#include <mrpt/maps/CPointsMap.h>
#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace delio {
/** One LiDAR observation as its source gives it: nothing corrected, nothing dropped. */
struct Scan {
    std::size_t index = 0;  //!< counts the observations of the chosen label, from 0
    double stamp_s = 0;     //!< seconds, as in times.txt (Unix seconds where there is no times.txt)
    mrpt::Clock::time_point time;  //!< the same as MRPT's clock has it

    /** Metres, in the sensor's frame (x forward, y left, z up), in the order of the sensor. NaN
     *  points may be among them. A CPointsMapXYZI where the source has intensities. */
    mrpt::maps::CPointsMap::Ptr points;

    /** Ring (laser) of each point where the source knows it, otherwise empty. */
    std::vector<std::uint16_t> rings;

    /** When each point was measured, in seconds from the stamp (before it: negative), where the
     *  source knows it, otherwise empty. NaN: the time of that point is not known. */
    std::vector<float> times_s;

    /** Pose of the sensor in the vehicle: maps sensor coordinates to vehicle coordinates. */
    Eigen::Isometry3d sensorPose = Eigen::Isometry3d::Identity();
};
}  // namespace delio
