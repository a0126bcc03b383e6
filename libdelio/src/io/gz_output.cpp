#include "gz_output.h"

#include <zlib.h>

#include <algorithm>
#include <stdexcept>

#include "delio/core/error.h"

namespace delio::io {
GzOutput::GzOutput(const std::string& path) : file_(gzopen(path.c_str(), "wb1")) {
    if (!file_) throw Error("cannot write '" + path + "'");
}

GzOutput::~GzOutput() { close(); }

std::size_t GzOutput::Write(const void* buffer, std::size_t count) {
    constexpr std::size_t kMost = 1U << 30;  // zlib counts in int
    for (std::size_t done = 0; done < count;) {
        const auto part = static_cast<unsigned>(std::min(count - done, kMost));
        const int written = gzwrite(file_, static_cast<const char*>(buffer) + done, part);
        if (written <= 0) throw std::runtime_error("the disk is full");
        done += static_cast<std::size_t>(written);
    }
    return count;
}

bool GzOutput::close() {
    const bool good = file_ && gzclose(file_) == Z_OK;
    file_ = nullptr;
    return good;
}

std::uint64_t GzOutput::getPosition() const { return static_cast<std::uint64_t>(gztell(file_)); }

std::size_t GzOutput::Read(void*, std::size_t) {
    throw std::logic_error("a file to write is not read from");
}

std::uint64_t GzOutput::Seek(std::int64_t, TSeekOrigin) {
    throw std::logic_error("a compressed file is written from front to back");
}
}  // namespace delio::io
