#pragma once
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimpleMap.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace delio::map {
/** Writes MRPT's gzip-compressed .simplemap. Throws Error if that fails. */
void saveSimplemap(const mrpt::maps::CSimpleMap& map, const std::string& path);

/** Throws Error for a file that is missing, no simplemap, or cut off. */
mrpt::maps::CSimpleMap loadSimplemap(const std::string& path);

/** All points of a simplemap in the world's frame, metres: of point clouds with their intensities,
 *  of any other observation what MRPT makes points of. Throws Error if clouds that are stored in
 *  other files cannot be read. */
mrpt::maps::CPointsMapXYZI pointsOf(const mrpt::maps::CSimpleMap& map);

/** Mean poses of its keyframes, in their order. */
std::vector<Eigen::Isometry3d> posesOf(const mrpt::maps::CSimpleMap& map);
}  // namespace delio::map
