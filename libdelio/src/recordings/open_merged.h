#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "delio/recordings/scan_reader.h"

namespace delio::io {
/** Opens a source with one sensor. */
using OpenSensor = std::function<std::unique_ptr<ScanReader>(const ScanSource& source)>;

/** Labels that `source.label` names: separated by commas, or `all` of the recording. One empty
 *  label: the reader chooses. Throws Error for an empty or a repeated name. */
std::vector<std::string> labelsOf(const ScanSource& source, const OpenSensor& open);

/** Scans of all `labels` in one; see MergedReader. Throws as openScans(). */
std::unique_ptr<ScanReader> openMerged(const ScanSource& source,
                                       const std::vector<std::string>& labels,
                                       const OpenSensor& open);
}  // namespace delio::io
