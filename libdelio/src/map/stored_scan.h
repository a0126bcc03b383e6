#pragma once
#include <mrpt/core/Clock.h>

#include <Eigen/Geometry>
#include <cstddef>

#include "files/spool.h"
#include "odometry/range_image.h"

namespace delio::map {
/** A scan that was put aside on the disk. */
struct StoredScan {
    std::size_t poseIndex = 0;
    Eigen::Isometry3d sensorPose = Eigen::Isometry3d::Identity();
    mrpt::Clock::time_point stamp;
    bool withIntensity = false, isKeyframe = false;
    /** x y z intensity each, sensor's frame: first the `still` static points, then the dynamic
     *  ones. */
    io::Spool::Place points;
    std::size_t still = 0;
    bool isLabelled = false;  //!< it is known which points are dynamic
    /** Range image of all its points; may be empty if free space is not needed. */
    io::Spool::Place view;
    int viewFirstRow = 0;

    /** Number of static points. */
    io::Spool::Place stillPoints() const { return {points.offset, 4 * still}; }
};

io::Spool::Place putAside(const odometry::PackedRanges& view, io::Spool& spool);
odometry::PackedRanges readView(const StoredScan& scan, const io::Spool& spool);
}  // namespace delio::map
