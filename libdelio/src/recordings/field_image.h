#pragma once
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace delio::io {
/** A field of an Ouster's turn as Ouster's recorder writes it. */
struct FieldImage {
    std::size_t rows = 0, columns = 0;
    std::vector<std::uint32_t> pixels;  //!< row by row
    /** Rows are shifted so that a column of the image lies in one direction. */
    bool isShifted = false;
};

/** Decodes a PNG (grey of 8 or 16 bits; colours whose bytes are those of one number, the lowest
 *  first) or a ZPNG (differences along the rows, packed by zstd). Throws Error for anything else,
 *  and for an image of another size. */
FieldImage fieldImageOf(std::string_view coded, std::size_t rows, std::size_t columns);
}  // namespace delio::io
