#pragma once
#include <stdlib.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "delio/core/error.h"

/** What the fuzz targets share. Each is fed bytes, hands them to a reader, and may see nothing but
 *  delio::Error come back. */
namespace delio::fuzz {
namespace fs = std::filesystem;

/** The bytes that a target is fed, from front to back. */
class Input {
 public:
    Input(const std::uint8_t* data, std::size_t size) : bytes_(data, data + size) {}

    /** Which of `count` formats the rest is of: '0' is the first. */
    std::size_t pick(std::size_t count) {
        if (bytes_.empty()) return 0;
        const auto letter = static_cast<std::uint8_t>(bytes_.front() - '0');
        bytes_.erase(0, 1);
        return letter % count;
    }
    /** What comes before a zero byte: of an input of two parts the first. */
    std::string cutText() {
        const std::string text = bytes_.substr(0, bytes_.find('\0'));
        bytes_.erase(0, text.size() + 1);
        return text;
    }
    const std::string& rest() const { return bytes_; }

 private:
    std::string bytes_;
};

/** The folder of this process's files; share/scripts/fuzz has TMPDIR in memory, and removes it. */
inline const fs::path& folder() {
    static const fs::path path = [] {
        std::string name = (fs::temp_directory_path() / "delio-fuzz-XXXXXX").string();
        return fs::path(mkdtemp(name.data()));
    }();
    return path;
}

/** Writes a file of that name, which may have folders in it, and gives its path. */
inline std::string fileOf(const std::string& bytes, const std::string& name) {
    const fs::path path = folder() / name;
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << bytes;
    return path.string();
}

/** Calls `read`; a file may be refused, with delio::Error and nothing else. */
template <typename Read>
int mayRefuse(const Read& read) {
    try {
        read();
    } catch (const Error&) {
    }
    return 0;
}
}  // namespace delio::fuzz
