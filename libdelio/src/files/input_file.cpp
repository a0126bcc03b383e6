#include "input_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
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

std::string beginOfInput(int file) {
    constexpr std::size_t kBytes = 16;
    std::array<char, kBytes> bytes{};
    ssize_t read = pread(file, bytes.data(), kBytes, 0);  // where it is a file
    if (read < 0) {
        int ends[2];
        if (pipe(ends) != 0) throw Error("cannot read standard input");
        // A pipe gives what was written at once, of which the first bytes are enough.
        read = tee(file, ends[1], kBytes, 0);
        if (read > 0) read = ::read(ends[0], bytes.data(), kBytes);
        close(ends[0]);
        close(ends[1]);
    }
    if (read < 0) throw Error("cannot read standard input: not a pipe or file");
    if (read == 0) throw Error("standard input is empty");
    return {bytes.data(), static_cast<std::size_t>(read)};
}
}  // namespace delio::io
