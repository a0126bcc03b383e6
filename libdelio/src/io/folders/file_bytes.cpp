#include "file_bytes.h"

#include <fstream>

#include "delio/core/error.h"

namespace delio::io {
std::vector<std::uint8_t> bytesOfFile(const std::filesystem::path& file) {
    std::error_code fault;
    const auto size = std::filesystem::file_size(file, fault);
    std::ifstream in(file, std::ios::binary);
    if (fault || !in) throw Error("cannot read '" + file.string() + "'");
    std::vector<std::uint8_t> bytes(size);
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (!in) throw Error("cannot read '" + file.string() + "': reading failed");
    return bytes;
}
}  // namespace delio::io
