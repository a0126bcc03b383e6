#pragma once
#include <cstddef>
#include <cstdint>

namespace delio::io {
/** Numbers in packets. */
inline std::uint32_t littleEndian(const std::uint8_t* from, std::size_t bytes) {
    std::uint32_t value = 0;
    for (std::size_t i = bytes; i-- > 0;) value = value << 8 | from[i];
    return value;
}

inline std::uint64_t bigEndian(const std::uint8_t* from, std::size_t bytes) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) value = value << 8 | from[i];
    return value;
}
}  // namespace delio::io
