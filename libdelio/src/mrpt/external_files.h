#pragma once
#include <mrpt/obs/CObservation.h>

#include <string>
#include <vector>

namespace delio::io {
/** Loads what an observation keeps outside of its rawlog from the first of `folders` that has it,
 *  and returns the file that the points came from; empty where they are in the rawlog. Of
 *  CObservationPointCloud and CObservation3DRangeScan. (MRPT itself looks in one folder, which is
 *  the whole process's.) Throws Error, which names the file or the folders tried, where it is
 *  missing, cut off or damaged. */
std::string loadExternal(mrpt::obs::CObservation& observation,
                         const std::vector<std::string>& folders);
}  // namespace delio::io
