#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace delio::io {
/** All of a file. Throws Error, which names it, where it cannot be read. */
std::vector<std::uint8_t> bytesOfFile(const std::filesystem::path& file);
}  // namespace delio::io
