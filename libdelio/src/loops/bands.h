#pragma once
#include <cstdint>

namespace delio::loops {
/** How many bits a byte has, without a table, so that the compiler counts many at once. */
constexpr std::uint8_t bitsOf(std::uint8_t bands) {
    const auto pairs = static_cast<std::uint8_t>(bands - ((bands >> 1) & 0x55));
    const auto fours = static_cast<std::uint8_t>((pairs & 0x33) + ((pairs >> 2) & 0x33));
    return static_cast<std::uint8_t>((fours + (fours >> 4)) & 0x0F);
}
}  // namespace delio::loops
