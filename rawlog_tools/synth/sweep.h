#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "drive.h"
#include "sensor_model.h"

namespace delio::synth {
/** One turn of the sensor: where and when each of its columns is fired. Columns go from straight
 *  ahead to the left and round, as in KITTI's files; in time a sensor on a roof turns the other way
 *  (clockwise seen from above) and begins at the back, so that it looks ahead in the middle of the
 *  turn. */
struct Sweep {
    double stamp_s = 0;                           //!< of the scan: the middle of the turn
    std::vector<double> azimuth_rad;              //!< 0 ahead, rising to the left, below 2 pi
    std::vector<double> time_s;                   //!< from the stamp
    std::vector<Eigen::Isometry3d> lidarToWorld;  //!< when the column was fired
};

/** How another sensor is mounted: in the frame of the first one, and how much later it stamps its
 *  scans. */
struct SecondSensor {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< its frame to the first one's
    double later_s = 0;                                      //!< than the first one's stamp
};

/** A sweep takes a scan period. `distort`: the columns are fired on the way; otherwise all from
 *  where the vehicle is at the stamp, at the stamp, as in scans whose motion was compensated. */
Sweep sweepOf(const Drive& drive, std::size_t scan, const SensorModel& sensor, bool distort,
              std::uint64_t seed, const SecondSensor& mounted = {});

/** When a column is fired, seconds from the scan's stamp. */
double firingTime(double azimuth_rad);
}  // namespace delio::synth
