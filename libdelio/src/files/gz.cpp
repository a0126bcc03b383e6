#include "gz.h"

#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include "delio/core/error.h"
#include "input_file.h"

namespace delio::io {
namespace {
// With damaged data zlib discards the buffer, so request no more than needed.
constexpr unsigned kBuffer = 1U << 15;
}  // namespace

GzInput::GzInput(const std::string& path) {
    std::error_code fault;
    if (path == "-") {
        size_ = std::numeric_limits<std::uint64_t>::max();
        input_ = dup(STDIN_FILENO);
        return;
    }
    if (std::filesystem::is_regular_file(path, fault)) {
        size_ = std::filesystem::file_size(path, fault);
        file_ = gzopen(path.c_str(), "rb");
    }
    if (!file_) throw Error("cannot read '" + path + "': no such file, or not readable");
    gzbuffer(file_, kBuffer);
}

GzInput::~GzInput() { file_ ? gzclose(file_) : close(input_); }

std::size_t GzInput::readPlain(void* buffer, std::size_t count) {
    buffer_.resize(kBuffer);
    if (taken_ == buffered_) {
        ssize_t read = -1;
        do read = ::read(input_, buffer_.data(), buffer_.size());
        while (read < 0 && errno == EINTR);
        if (read < 0) throw std::runtime_error(std::strerror(errno));
        taken_ = 0;
        buffered_ = static_cast<std::size_t>(read);
        ended_ = read == 0;
    }
    const std::size_t some = std::min(count, buffered_ - taken_);
    std::memcpy(buffer, buffer_.data() + taken_, some);
    taken_ += some;
    position_ += some;
    return some;
}

std::size_t GzInput::readSome(void* buffer, std::size_t count) {
    if (!file_ && position_ == 0 && beginOfInput(input_).rfind("\x1f\x8b", 0) == 0) {
        file_ = gzdopen(input_, "rb");
        gzbuffer(file_, kBuffer);
    }
    if (!file_) return readPlain(buffer, count);
    constexpr std::size_t kMost = 1U << 30;  // zlib counts in int
    const int read = gzread(file_, buffer, static_cast<unsigned>(std::min(count, kMost)));
    int state = Z_OK;
    const char* message = gzerror(file_, &state);
    // Only the state shows that the file is cut off; data before the cut are returned first.
    if (read < 0 || (read == 0 && state != Z_OK)) throw std::runtime_error(message);
    ended_ = read == 0;
    return static_cast<std::size_t>(read);
}

std::size_t GzInput::Read(void* buffer, std::size_t count) {
    std::size_t done = 0;
    while (done < count) {
        const auto read = readSome(static_cast<char*>(buffer) + done, count - done);
        if (read == 0 && done == 0) return 0;
        if (read == 0) throw std::runtime_error("the file ends early");
        done += read;
    }
    return done;
}

void GzInput::skipToEnd(std::uint64_t most) {
    std::array<char, 1U << 14> unused{};
    while (!ended_ && getPosition() <= most) readSome(unused.data(), unused.size());
}

bool GzInput::endedWell() const { return ended_; }

bool GzInput::compressed() const {
    return size_ == std::numeric_limits<std::uint64_t>::max() || gzdirect(file_) == 0;
}

std::uint64_t GzInput::getPosition() const {
    return file_ ? static_cast<std::uint64_t>(gztell(file_)) : position_;
}

std::size_t GzInput::Write(const void*, std::size_t) {
    throw std::logic_error("a file to read is not written to");
}

std::uint64_t GzInput::Seek(std::int64_t, TSeekOrigin) {
    throw std::logic_error("a compressed file is read from front to back");
}

std::uint64_t unpackedSize(const std::string& path) {
    GzInput in(path);
    const bool isPacked = in.compressed();
    if (isPacked) in.skipToEnd(kMostBytes);
    const auto size = isPacked ? in.getPosition() : in.getTotalBytesCount();
    if (size > kMostBytes) throw Error("'" + path + "' is too large for one scan");
    return size;
}

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
