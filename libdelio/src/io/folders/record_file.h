#pragma once
#include <cstddef>
#include <fstream>
#include <string>
#include <vector>

namespace delio::io {
/** What PLY and PCD share: a point is a record of numbers, each with a name. */
struct Column {
    std::string name;       //!< one that there is no use for is skipped
    char kind = 'F';        //!< 'F' floating, 'I' and 'U' whole, with and without a sign
    std::size_t bytes = 4;  //!< F: 4 or 8; I and U: 1, 2, 4 or 8
};

/** True where there is such a number. */
bool isNumber(char kind, std::size_t bytes);

/** From one record to the next, bytes. */
std::size_t strideOf(const std::vector<Column>& columns);

/** A file of records that is read: its header first, by who knows its kind, then its records. */
class RecordFile {
 public:
    /** @param kind names the kind in errors: "PLY". Throws Error where there is no such file. */
    RecordFile(const std::string& path, std::string kind);

    /** The header's next line; false at the end. */
    bool line(std::string& text) { return static_cast<bool>(std::getline(in_, text)); }

    /** What has not been read yet; 0 where that cannot be told (a pipe). */
    std::size_t bytesLeft();

    std::istream& stream() { return in_; }

    /** Throws an Error that names the file. */
    [[noreturn]] void refuse(const std::string& why) const;
    /** The same: it ends, or cannot be understood, after `done` of `count` points. */
    [[noreturn]] void refuseCut(std::size_t done, std::size_t count) const;

 private:
    std::string path_, kind_;
    std::ifstream in_;
};
}  // namespace delio::io
