#pragma once
#include "delio/run/run_folder.h"

namespace delio::picture {
/** The pictures of a run: map.3Dscene and map.png where there are points, map_removal.png
 *  where something dynamic was taken out of them, before (in red what was) beside after in the same
 *  view, and trajectory.png, from above; where the graph had something to optimise, before and
 * after it side by side. To be given to run::RunFolder::write(). Throws Error where one cannot be
 * drawn or written. */
void illustrate(const run::RunRecord& record, const map::BuiltMap& map,
                const run::RunFolder& folder);
}  // namespace delio::picture
