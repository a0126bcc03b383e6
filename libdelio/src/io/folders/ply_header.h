#pragma once
#include <vector>

#include "record_file.h"

namespace delio::io {
struct PlyHeader {
    bool ascii = false, bigEndian = false;
    std::size_t vertices = 0;
    std::vector<Column> columns;  //!< of a vertex
};

/** Reads up to and including `end_header`. Only the first element is looked at: it has to be the
 *  vertices. Throws Error for anything else. */
PlyHeader readPlyHeader(RecordFile& file);
}  // namespace delio::io
