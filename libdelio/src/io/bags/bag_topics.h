#pragma once
#include <string>
#include <vector>

#include "delio/io/scan_reader.h"
#include "message_source.h"

namespace delio::io {
/** The topic that is asked for, or the only one with scans. Throws Error, which does not name the
 *  file, where there is none, there are several, or that one has no scans; it lists what there
 *  is. */
Topic chooseTopic(const std::vector<Topic>& topics, const std::string& asked);

/** The json of the Ouster whose packets are in `topic`: the file `source.sensorFile`, what the
 * topic
 *  .../metadata of the bag says whose name has the most in common with it, or the .json beside the
 *  bag. Throws Error where there is none of them. */
SideFile ousterDescription(const ScanSource& source, const std::string& topic,
                           const OpenSource& open);
}  // namespace delio::io
