#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "../point_table.h"
#include "record_file.h"

namespace delio::io {
/** The points of a file, as PointTable takes them. */
struct CloudRecords {
    PointLayout layout;
    std::vector<std::uint8_t> bytes;
    std::size_t count = 0;
    std::size_t rows = 1;  //!< more than one: of an organised cloud
};

/** As a layout names it: in lower case, without what programs put before and about it
 *  ("scalar_Intensity", "//X"). */
std::string plainName(std::string name);

/** Records of these columns, without gaps. */
PointLayout layoutOf(const std::vector<Column>& columns);
/** Records of doubles. */
PointLayout layoutOfDoubles(const std::vector<std::string>& names);

/** Whole numbers of 8 bytes, which a layout has no kind for, become doubles where they lie.
 *  `columns` are those of records.layout. */
void makeDoubles(const std::vector<Column>& columns, CloudRecords& records);

/** Reads what comes after the header: `count` records, or as many lines of numbers where `ascii`.
 *  Throws Error, which names the file, before memory is taken where there is not as much. */
CloudRecords readRecords(RecordFile& file, const std::vector<Column>& columns, std::size_t count,
                         bool ascii);
}  // namespace delio::io
