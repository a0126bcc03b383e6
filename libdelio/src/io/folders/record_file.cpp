#include "record_file.h"

#include <locale>

#include "delio/core/error.h"

namespace delio::io {
bool isNumber(char kind, std::size_t bytes) {
    if (kind == 'F') return bytes == 4 || bytes == 8;
    return (kind == 'U' || kind == 'I') && (bytes == 1 || bytes == 2 || bytes == 4 || bytes == 8);
}

std::size_t strideOf(const std::vector<Column>& columns) {
    std::size_t stride = 0;
    for (const auto& column : columns) stride += column.bytes;
    return stride;
}

RecordFile::RecordFile(const std::string& path, std::string kind)
    : path_(path), kind_(std::move(kind)), in_(path, std::ios::binary) {
    if (!in_) throw Error("cannot read '" + path + "': there is no such file");
    in_.imbue(std::locale::classic());
}

void RecordFile::refuse(const std::string& why) const {
    throw Error("'" + path_ + "' is not a " + kind_ + " that can be read: " + why);
}

void RecordFile::refuseCut(std::size_t done, std::size_t count) const {
    refuse("it is cut off or malformed after " + std::to_string(done) + " of " +
           std::to_string(count) + " points");
}

std::size_t RecordFile::bytesLeft() {
    const auto here = in_.tellg();
    in_.seekg(0, std::ios::end);
    const auto end = in_.tellg();
    in_.clear();
    if (here < 0 || end < here) return 0;
    in_.seekg(here);
    return static_cast<std::size_t>(end - here);
}
}  // namespace delio::io
