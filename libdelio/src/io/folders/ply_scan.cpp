#include "ply_scan.h"

#include "ply_header.h"

namespace delio::io {
CloudRecords readPlyScan(const std::string& path) {
    RecordFile file(path, "PLY");
    if (file.bytesLeft() == 0) file.refuse("it is empty");
    const auto header = readPlyHeader(file);
    auto records = readRecords(file, header.columns, header.vertices, header.ascii);
    records.layout.bigEndian = header.bigEndian;
    return records;
}
}  // namespace delio::io
