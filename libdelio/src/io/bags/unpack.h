#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace delio::io {
/** Unpacks `packed`, which is a whole bz2 stream ("bz2"), LZ4 frame ("lz4") or zstd frame ("zstd"),
 *  into `out`. `size`: what comes out as the bag has it, at most kMostBytes; memory is taken as
 * bytes come out, not for what is announced. Throws Error for any other compression, damaged or cut
 * data, and where another number of bytes comes out. */
void unpack(const std::string& compression, const std::vector<std::uint8_t>& packed,
            std::uint64_t size, std::vector<std::uint8_t>& out);
}  // namespace delio::io
