#pragma once
#include <filesystem>

#include "point_records.h"

namespace delio::io {
/** The points of a .txt or .csv file, a line each: x y z, and where they are there intensity, time
 *  and ring, between spaces, tabs, commas or semicolons. A first line of names gives another order
 *  and more columns. Lines that begin with '#' and blank ones are passed over. Throws Error, which
 *  names file and line, for anything else; the file for one that is missing or without points. */
CloudRecords readTextScan(const std::filesystem::path& file);
}  // namespace delio::io
