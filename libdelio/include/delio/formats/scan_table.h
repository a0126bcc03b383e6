#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace delio::io {
/** Columns of delio-slam's scans.csv needed for evaluation, one row per used scan. */
struct ScanTable {
    std::vector<std::size_t> scans;  //!< scan numbers in the rawlog, increasing
    std::vector<double> stamps_s;    //!< of these scans, seconds of the drive
    std::vector<bool> predicted;     //!< the scan could not be registered
};

/** Reads the columns `scan`, `stamp_s` and `predicted` of a scans.csv. Throws Error with file and
 *  line where one is missing or malformed. */
ScanTable readScanTable(const std::string& path);

/** A row of scans.csv. */
struct ScanRow {
    std::size_t scan = 0;                                     //!< scan number in the rawlog
    double stamp_s = 0;                                       //!< seconds of the drive
    std::vector<std::pair<std::string, std::string>> values;  //!< name of the column, and text
    bool predicted = false;                                   //!< it could not be registered
    std::string reason;                                       //!< why it was predicted
};

/** Lines of scans.csv, with their ends: the first, which names the columns of `row`, and a row. */
std::string scanTableHeading(const ScanRow& row);
/** See scanTableHeading(). */
std::string scanTableLine(const ScanRow& row);

/** Writes `scan,stamp_s,<values>,predicted,reason`, where the columns in the middle are those of
 *  the first row (none where there are no rows); stamps have seven decimals. A comma in a text
 *  becomes ';' and a line end a space. Throws Error where a row's columns are not those of the
 *  first, or where the file cannot be written. */
void writeScanTable(std::size_t rows, const std::function<ScanRow(std::size_t)>& rowAt,
                    const std::string& path);
}  // namespace delio::io
