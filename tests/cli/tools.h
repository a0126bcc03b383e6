#pragma once
#include <string>
#include <vector>

namespace delio::test {
inline const std::vector<std::string> kTools = {
    "delio-slam",   "delio-eval",   "delio-map",    "delio-snapshot", "delio-figures",
    "kitti2rawlog", "rawlog2kitti", "scans2rawlog", "synth2rawlog",
#ifdef DELIO_LIVE
    "delio-live",
#endif
};
}  // namespace delio::test
