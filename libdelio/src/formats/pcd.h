#pragma once
#include <optional>
#include <string>
#include <vector>

#include "point_records.h"

namespace delio::io {
struct PcdHeader {
    std::vector<std::string> names, sizes, types, counts;  //!< a word a field
    std::optional<std::size_t> points, width, height;      //!< where it says them
    std::vector<std::string> viewpoint;                    //!< x y z qw qx qy qz
    std::string data;                                      //!< ascii, binary, binary_compressed
};

/** Reads up to and including the line `DATA`. Throws Error if it is missing. `points` is width
 *  times height if the file has no POINTS. */
PcdHeader readPcdHeader(RecordFile& file);

/** A field with a count of more than one is as many columns, of which the first has its name.
 *  Throws Error where the header contradicts itself. */
std::vector<Column> columnsOf(const PcdHeader& header, const RecordFile& file);

/** The points of a .pcd file: ascii, binary or binary_compressed. Its viewpoint is not looked at.
 *  Throws Error, which names the file, for one that is missing, cut off, contradicts itself or
 *  promises more than it has. */
CloudRecords readPcdScan(const std::string& path);
}  // namespace delio::io
