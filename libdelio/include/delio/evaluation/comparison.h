#pragma once
#include <mrpt/poses/CPose3D.h>

#include <vector>

#include "delio/evaluation/report.h"

namespace delio::evaluation {
/** One estimate on one sequence, pose by pose: `reference[i]`, `estimate[i]`, `times_s[i]` and
 *  `predicted[i]` belong together. */
struct Comparison {
    ReportRow row;
    std::vector<mrpt::poses::CPose3D> reference;
    std::vector<mrpt::poses::CPose3D> estimate;
    std::vector<double> times_s;   //!< since the first pose
    bool timesAreAssumed = false;  //!< no file has times: ten poses a second, as KITTI has it
    std::vector<bool> predicted;   //!< scans that were not registered; empty where not known
};
}  // namespace delio::evaluation
