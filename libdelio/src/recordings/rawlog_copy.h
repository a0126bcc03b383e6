#pragma once
#include <mrpt/obs/CObservation.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "delio/core/increment.h"

namespace delio::io {
/** Motions of the vehicle, one after the other. */
using Motions = std::vector<Increment>;

/** Motions up to a scan, from the scan of the call before; nothing where an observation is no scan
 *  that gets an action. */
using MotionsUpTo = std::function<std::optional<Motions>(const mrpt::obs::CObservation&)>;

/** Copies a rawlog object by object. Before each scan with motions it puts a CActionCollection with
 *  their composition as CActionRobotMovement3D, into the input's own collection where that comes
 *  right before. A bare scan becomes a CSensoryFrame; other objects keep their bytes. It ends where
 *  the input is damaged. Throws Error where the files cannot be opened or written. */
void copyWithActions(const std::string& input, const std::string& output,
                     const MotionsUpTo& motionsUpTo);
}  // namespace delio::io
