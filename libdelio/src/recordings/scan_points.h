#pragma once
#include <mrpt/maps/CPointsMap.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <functional>

#include "delio/odometry/scan.h"

namespace delio::io {
/** A map without points that has intensities where `points` has them. */
mrpt::maps::CPointsMap::Ptr emptyLike(const mrpt::maps::CPointsMap& points);

/** Appends a point of `from`, moved by `pose`; its intensity is 0 where `from` has none. */
void addPoint(const mrpt::maps::CPointsMap& from, std::size_t i, const Eigen::Isometry3d& pose,
              mrpt::maps::CPointsMap& to);

/** The scan with the points for which `isWanted(i)`, with their rings and times. */
Scan partOf(const Scan& scan, const std::function<bool(std::size_t)>& isWanted);
}  // namespace delio::io
