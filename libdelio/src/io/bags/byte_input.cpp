#include "byte_input.h"

#include <filesystem>

#include "delio/core/error.h"

namespace delio::io {
namespace {
constexpr std::size_t kBuffer = 1 << 18;
}

void ByteInput::read(void* to, std::uint64_t bytes) {
    if (bytes > left()) tooShort();
    if (bytes == 0) return;
    get(to, bytes);
    position_ += bytes;
}

void ByteInput::check(std::uint64_t bytes) const {
    if (bytes > left()) tooShort();
    if (bytes > kMostBytes)
        throw Error("is damaged: " + std::to_string(bytes) + " bytes in one piece are announced");
}

void ByteInput::read(std::vector<std::uint8_t>& to, std::uint64_t bytes) {
    check(bytes);
    to.resize(bytes);
    read(to.data(), bytes);
}

void ByteInput::skip(std::uint64_t bytes) {
    if (bytes > left()) tooShort();
    pass(bytes);
    position_ += bytes;
}

std::string ByteInput::text() {
    const auto length = number<std::uint32_t>();
    check(length);
    std::string text(length, '\0');
    read(text.data(), length);
    return text;
}

Bytes ByteInput::view(std::vector<std::uint8_t>& buffer, std::uint64_t bytes) {
    read(buffer, bytes);
    return {buffer.data(), buffer.size()};
}

FileInput::FileInput(const std::string& path) {
    std::error_code fault;
    bytes_ = std::filesystem::file_size(path, fault);
    file_ = fault ? nullptr : std::fopen(path.c_str(), "rb");
    if (!file_) throw Error("cannot be opened");
    std::setvbuf(file_, nullptr, _IOFBF, kBuffer);
    start(bytes_);
}

FileInput::~FileInput() { std::fclose(file_); }

void FileInput::seek(std::uint64_t position) {
    if (position > bytes_) throw Error("is cut off at byte " + std::to_string(bytes_));
    if (fseeko(file_, static_cast<off_t>(position), SEEK_SET) != 0) throw Error("cannot be read");
    start(bytes_, position);
}

void FileInput::get(void* to, std::size_t bytes) {
    if (std::fread(to, 1, bytes, file_) != bytes) throw Error("cannot be read");
}

void FileInput::pass(std::uint64_t bytes) {
    // A seek drops what was read ahead: small steps are read.
    char scratch[4096];
    if (bytes <= sizeof(scratch))
        get(scratch, bytes);
    else if (fseeko(file_, static_cast<off_t>(bytes), SEEK_CUR) != 0)
        throw Error("cannot be read");
}

void FileInput::tooShort() const {
    throw Error("is cut off: at byte " + std::to_string(position()) +
                " more is announced than its " + std::to_string(bytes_) + " bytes");
}

Bytes MemoryInput::view(std::vector<std::uint8_t>&, std::uint64_t bytes) {
    const std::uint64_t begin = position();
    skip(bytes);
    return {bytes_.data() + begin, bytes};
}

void MemoryInput::get(void* to, std::size_t bytes) {
    std::memcpy(to, bytes_.data() + position(), bytes);
}

void MemoryInput::tooShort() const {
    throw Error("is damaged: in a chunk of " + std::to_string(bytes_.size()) +
                " bytes more is announced at byte " + std::to_string(position()));
}
}  // namespace delio::io
