#pragma once
#include <string>
#include <vector>

#include "point_records.h"

namespace delio::io {
struct PlyHeader {
    bool ascii = false, bigEndian = false;
    std::size_t vertices = 0;
    std::vector<Column> columns;  //!< of a vertex
};

/** Reads up to and including `end_header`. Only the first element is looked at: it has to be the
 *  vertices. Throws Error for anything else. */
PlyHeader readPlyHeader(RecordFile& file);

/** The vertices of a .ply file: ascii or binary, little- or big-endian; elements after them are
 *  passed over. Throws Error, which names the file, for one that is missing, cut off or promises
 *  more than it has, and where another element comes first or a vertex has a list. */
CloudRecords readPlyScan(const std::string& path);
}  // namespace delio::io
