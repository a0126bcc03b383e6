#pragma once
#include <string>
#include <vector>

#include "map_input.h"

namespace delio {
/** The .pcd files in a folder, in the order of their names. Throws Error if the folder has no such
 * file. */
std::vector<std::string> pcdFilesIn(const std::string& folder);

/** The map of the scans in a folder: of all its .pcd files. Their points are in one frame, and
 *  VIEWPOINT is the pose of the sensor there (the layout of DynamicMap_Benchmark). Points that
 * other scans saw through become MapInput::dynamic, the others MapInput::points. Every point is
 * kept. Throws Error for files that cannot be read, and where VIEWPOINT is missing or is the same
 * in all files. */
MapInput cleanedFolder(const std::string& folder);
}  // namespace delio
