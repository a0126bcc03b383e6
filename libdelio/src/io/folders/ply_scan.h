#pragma once
#include <string>

#include "cloud_records.h"

namespace delio::io {
/** The vertices of a .ply file: ascii or binary, little- or big-endian; elements after them are
 *  passed over. Throws Error, which names the file, for one that is missing, cut off or promises
 *  more than it has, and where another element comes first or a vertex has a list. */
CloudRecords readPlyScan(const std::string& path);
}  // namespace delio::io
