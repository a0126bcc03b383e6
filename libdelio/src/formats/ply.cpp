#include "ply.h"

#include <array>
#include <sstream>

#include "delio/core/text.h"

namespace delio::io {
namespace {
/** A type of the format, by both of its names. */
struct Type {
    const char *name, *sized;
    char kind;
    std::size_t bytes;
};
const std::array<Type, 8> kTypes{{{"char", "int8", 'I', 1},
                                  {"uchar", "uint8", 'U', 1},
                                  {"short", "int16", 'I', 2},
                                  {"ushort", "uint16", 'U', 2},
                                  {"int", "int32", 'I', 4},
                                  {"uint", "uint32", 'U', 4},
                                  {"float", "float32", 'F', 4},
                                  {"double", "float64", 'F', 8}}};

Column columnOf(const std::string& type, const std::string& name, const RecordFile& file) {
    for (const auto& known : kTypes)
        if (type == known.name || type == known.sized) return {name, known.kind, known.bytes};
    file.refuse("a vertex has a property of type '" + type + "'");
}

void takeFormat(const std::string& format, const RecordFile& file, PlyHeader& header) {
    header.ascii = format == "ascii";
    header.bigEndian = format == "binary_big_endian";
    if (!header.ascii && !header.bigEndian && format != "binary_little_endian")
        file.refuse("its format '" + format + "' is not supported");
}
}  // namespace

PlyHeader readPlyHeader(RecordFile& file) {
    PlyHeader header;
    unsigned element = 0;
    bool formatKnown = false;
    std::string line;
    for (unsigned row = 0; file.line(line); ++row) {
        if (row > 10000 || (row == 0 && line.substr(0, 3) != "ply")) break;
        std::istringstream words(line);
        std::string keyword, first, second;
        words >> keyword >> first >> second;
        if (keyword == "format") {
            takeFormat(first, file, header);
            formatKnown = true;
        } else if (keyword == "element" && ++element == 1) {
            const auto count = numberIn<std::size_t>(second);
            if (first != "vertex" || !count)
                file.refuse("the first element must be 'vertex' with a count");
            header.vertices = *count;
        } else if (keyword == "property" && element == 1) {
            header.columns.push_back(columnOf(first, second, file));
        } else if (keyword == "end_header") {
            if (!formatKnown || element == 0) break;
            return header;
        }
    }
    file.refuse("the header is incomplete");
}

CloudRecords readPlyScan(const std::string& path) {
    RecordFile file(path, "PLY");
    if (file.bytesLeft() == 0) file.refuse("the file is empty");
    const auto header = readPlyHeader(file);
    auto records = readRecords(file, header.columns, header.vertices, header.ascii);
    records.layout.bigEndian = header.bigEndian;
    return records;
}
}  // namespace delio::io
