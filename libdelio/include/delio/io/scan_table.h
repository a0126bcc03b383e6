#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace delio::io {
/** What an evaluation needs of the scans.csv that delio-slam writes, a row for each used scan. */
struct ScanTable {
    std::vector<std::size_t> scans;  //!< numbers of the scans in their rawlog, rising
    std::vector<double> stamps_s;
    std::vector<bool> predicted;  //!< the scan could not be registered
};

/** Reads `scan`, `stamp_s` and `predicted` of a scans.csv, wherever these columns are.
 *  Throws Error with file and line where one is missing or malformed. */
ScanTable readScanTable(const std::string& path);
}  // namespace delio::io
