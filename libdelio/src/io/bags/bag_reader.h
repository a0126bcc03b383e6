#pragma once
#include <memory>
#include <string>

#include "delio/io/scan_reader.h"

namespace delio::io {
/** Read the messages with scans of one topic. Throw as openScans(). */
std::unique_ptr<ScanReader> openRos1Bag(const ScanSource& source);
/** A .db3 file. */
std::unique_ptr<ScanReader> openRos2Database(const ScanSource& source);
std::unique_ptr<ScanReader> openMcap(const ScanSource& source);
/** A folder with metadata.yaml and the .db3 or .mcap files that it names. */
std::unique_ptr<ScanReader> openRos2Folder(const ScanSource& source);
}  // namespace delio::io
