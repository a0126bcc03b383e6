#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace delio::io {
/** All of a file. Throws Error, which names it, where it cannot be read. */
std::vector<std::uint8_t> bytesOfFile(const std::filesystem::path& file);

/** Most bytes that readers take into memory in one piece: a chunk or a part that is unpacked, a
 *  message, a text. It is far more than a scan has; a file that announces more is damaged, or made
 *  to fill the memory. */
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;

/** True where there is a file at `path`. Throws Error where something else is there: a pipe would
 * be waited for, a device has no end. For files that nobody has named but that are looked for. */
bool isFileThere(const std::string& path);

/** The first bytes of standard input, 16 at most, which stay there. Throws Error where it is empty,
 *  or neither a pipe nor a file. `file`: its descriptor. */
std::string beginOfInput(int file);
}  // namespace delio::io
