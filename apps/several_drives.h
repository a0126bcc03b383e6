#pragma once
#include <functional>
#include <string>
#include <vector>

#include "delio/run/run.h"

namespace delio {
/** How the run of a drive ended. */
struct DriveResult {
    int exitCode = 0;
    bool extended = false;  //!< its map is the one that it was localised in and its own
    bool grown = false;     //!< which has places that the other did not have
};

/** Runs one drive into the folder of its settings, which users know as `place`. Throws where it
 *  fails. */
using SlamDrive = std::function<DriveResult(
    const std::string& input, const run::RunSettings& settings, const std::string& place)>;

/** Several drives in one frame and one map where they meet, and separate where they do not: each in
 *  a folder of its own name in `settings.folder`; there also map.delio (map-2.delio ... of what is
 *  separate), NAME_kitti.txt and NAME_tum.txt with each drive's poses in its map, and drives.csv,
 *  which lists the map of each drive. All come into their places together, after the last drive,
 * and drives.csv last. Drives that fail are skipped and set the exit code; without any
 *  result, existing files are kept. */
int slamSeveral(const std::vector<std::string>& inputs, const run::RunSettings& settings,
                const SlamDrive& slam);

/** Paths of all that slamSeveral() replaces or takes away in `folder`. `map`: the stored map that
 *  is extended; empty: none. Throws Error where two drives, or a drive and another file, would have
 *  one name. */
std::vector<std::string> filesOfSeveral(const std::vector<std::string>& inputs,
                                        const std::string& map, const std::string& folder);
}  // namespace delio
