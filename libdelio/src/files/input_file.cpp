#include "input_file.h"

#include <filesystem>
#include <fstream>

#include "delio/core/error.h"

namespace delio::io {
std::vector<std::uint8_t> bytesOfFile(const std::filesystem::path& file) {
    std::error_code fault;
    const auto size = std::filesystem::file_size(file, fault);
    if (fault) throw Error("cannot read '" + file.string() + "': " + fault.message());
    if (size > kMostBytes) throw Error("'" + file.string() + "' is too large for a scan");
    std::ifstream in(file, std::ios::binary);
    if (!in) throw Error("cannot read '" + file.string() + "'");
    std::vector<std::uint8_t> bytes(size);
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (!in) throw Error("cannot read '" + file.string() + "': reading failed");
    return bytes;
}

bool isFileThere(const std::string& path) {
    const auto status = std::filesystem::status(path);
    if (!std::filesystem::exists(status)) return false;
    if (!std::filesystem::is_regular_file(status))
        throw Error("cannot read '" + path + "': not a regular file");
    return true;
}
}  // namespace delio::io
