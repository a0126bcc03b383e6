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

/** An Ouster's json: the file `source.sensorFile`, what a topic .../metadata of the bag says, or
 *  the .json beside the bag. Throws Error where there is none of them. */
SideFile ousterDescription(const ScanSource& source, const OpenSource& open);
}  // namespace delio::io
