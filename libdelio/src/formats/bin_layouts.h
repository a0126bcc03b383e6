#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "point_records.h"

namespace delio::io {
/** A record that producers of .bin files write for each point, without a header. */
struct BinLayout {
    const char* name;
    std::vector<Column> columns;  //!< "_": not used

    std::size_t step() const { return strideOf(columns); }
};

const std::vector<BinLayout>& binLayouts();
/** Their names, for messages. */
std::string binLayoutNames();
/** Throws Error, which lists the names, for an unknown one. */
const BinLayout& binLayoutNamed(const std::string& name);

/** The layouts that the bytes of a scan fit, by their size and by what lies where rings and times
 *  have to. Those with neither, KITTI's, fit only where no other one does. */
std::vector<const BinLayout*> binLayoutsOf(const std::vector<std::uint8_t>& bytes);

/** True where points of that many bytes begin with x, y and z as floats: neither huge nor so small
 *  that a whole number was taken for a float. */
bool beginWithFloats(const std::vector<std::uint8_t>& bytes, std::size_t step);

/** NCLT's whole numbers as floats in metres, with z up. */
CloudRecords recordsOfNclt(const std::vector<std::uint8_t>& bytes);

/** MulRan's scans are whole turns of an Ouster of 64 rows and 1024 columns, column by column, which
 *  gives each point its ring and its part of the turn. False for another cloud. */
bool isMulran(const std::vector<std::uint8_t>& bytes);
/** With a time for each point; a turn takes 0.1 s. */
CloudRecords recordsOfMulran(const std::vector<std::uint8_t>& bytes);
}  // namespace delio::io
