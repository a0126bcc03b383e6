#pragma once
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace delio::io {
/** Kinds of numbers, numbered as sensor_msgs/PointField has them. */
enum class NumberKind : std::uint8_t {
    kInt8 = 1,
    kUint8,
    kInt16,
    kUint16,
    kInt32,
    kUint32,
    kFloat32,
    kFloat64
};
/** 0: there is no such kind. */
std::size_t bytesOf(NumberKind kind);

/** One number of a point's record. */
struct PointField {
    std::string name;
    std::size_t offset = 0;  //!< in the record, bytes
    NumberKind kind = NumberKind::kFloat32;
};

/** Points as records of named numbers, as ROS, PCD and PLY have them. */
struct PointLayout {
    std::vector<PointField> fields;
    std::size_t step = 0;  //!< from one record to the next, bytes
    bool bigEndian = false;
};

/** Common part of PLY and PCD: a point is a record of named numbers. */
struct Column {
    std::string name;       //!< one that there is no use for is skipped
    char kind = 'F';        //!< 'F' floating, 'I' and 'U' whole, with and without a sign
    std::size_t bytes = 4;  //!< F: 4 or 8; I and U: 1, 2, 4 or 8
};

/** True where there is such a number. */
bool isNumber(char kind, std::size_t bytes);

/** From one record to the next, bytes. */
std::size_t strideOf(const std::vector<Column>& columns);

/** A file of records that is read: its header first, by the reader of its kind, then its records.
 */
class RecordFile {
 public:
    /** @param kind names the kind in errors: "PLY". Throws Error where there is no such file. */
    RecordFile(const std::string& path, std::string kind);

    /** The header's next line; false at the end. */
    bool line(std::string& text) { return static_cast<bool>(std::getline(in_, text)); }

    /** Bytes left to read; 0 if unknown (a pipe). */
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

/** The points of a file, as PointTable takes them. */
struct CloudRecords {
    PointLayout layout;
    std::vector<std::uint8_t> bytes;
    std::size_t count = 0;
    std::size_t rows = 1;  //!< more than one: of an organised cloud
};

/** Normalised field name: lower case, without prefixes of other programs ("scalar_Intensity",
 *  "//X"). */
std::string plainName(std::string name);

/** Records of these columns, without gaps. */
PointLayout layoutOf(const std::vector<Column>& columns);
/** Records of doubles. */
PointLayout layoutOfDoubles(const std::vector<std::string>& names);

/** Whole numbers of 8 bytes, which a layout has no kind for, become doubles where they lie.
 *  `columns` are those of records.layout. */
void makeDoubles(const std::vector<Column>& columns, CloudRecords& records);

/** Reads the data after the header: `count` records, or lines of numbers if `ascii`. Throws an
 *  Error that names the file, before allocating memory, if the file is too short. */
CloudRecords readRecords(RecordFile& file, const std::vector<Column>& columns, std::size_t count,
                         bool ascii);
}  // namespace delio::io
