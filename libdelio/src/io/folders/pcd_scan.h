#pragma once
#include <string>

#include "cloud_records.h"

namespace delio::io {
/** The points of a .pcd file: ascii, binary or binary_compressed. Its viewpoint is not looked at.
 *  Throws Error, which names the file, for one that is missing, cut off, contradicts itself or
 *  promises more than it has. */
CloudRecords readPcdScan(const std::string& path);
}  // namespace delio::io
