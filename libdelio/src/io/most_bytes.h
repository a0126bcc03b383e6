#pragma once
#include <cstdint>

namespace delio::io {
/** Most bytes that readers take into memory in one piece: a chunk or a part that is unpacked, a
 *  message, a text. It is far more than a scan has; a file that announces more is damaged, or made
 *  to fill the memory. */
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;
}  // namespace delio::io
