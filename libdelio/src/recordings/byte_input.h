#pragma once
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "files/input_file.h"
#include "message_source.h"

namespace delio::io {
/** Bytes to be read from front to back. No length is trusted: reading beyond the end is an Error
 *  ("is cut off at byte N") before memory is allocated. */
class ByteInput {
 public:
    ByteInput() = default;
    virtual ~ByteInput() = default;
    ByteInput(const ByteInput&) = delete;
    ByteInput& operator=(const ByteInput&) = delete;

    std::uint64_t position() const { return position_; }
    std::uint64_t left() const { return size_ - position_; }

    void read(void* to, std::uint64_t bytes);
    /** Makes `to` hold the next `bytes` bytes, kMostBytes at most. */
    void read(std::vector<std::uint8_t>& to, std::uint64_t bytes);
    /** The next `bytes` bytes where they lie in memory; those of a file are read into `buffer`. */
    virtual Bytes view(std::vector<std::uint8_t>& buffer, std::uint64_t bytes);
    void skip(std::uint64_t bytes);

    /** A little-endian number. */
    template <typename Number>
    Number number() {
        static_assert(std::is_unsigned_v<Number>);
        std::uint8_t bytes[sizeof(Number)];
        read(bytes, sizeof(Number));
        Number value = 0;
        std::memcpy(&value, bytes, sizeof(Number));
        return value;
    }
    /** A text behind its length of four bytes. */
    std::string text();

 protected:
    void start(std::uint64_t size, std::uint64_t position = 0) {
        size_ = size;
        position_ = position;
    }

 private:
    virtual void get(void* to, std::size_t bytes) = 0;
    virtual void pass(std::uint64_t bytes) = 0;
    [[noreturn]] virtual void tooShort() const = 0;
    /** Throws Error where so many bytes are not there, or are too many for one piece. */
    void check(std::uint64_t bytes) const;

    std::uint64_t size_ = 0, position_ = 0;
};

/** A file. Throws Error where it cannot be opened or read. */
class FileInput : public ByteInput {
 public:
    explicit FileInput(const std::string& path);
    ~FileInput() override;

    std::uint64_t size() const { return bytes_; }
    void seek(std::uint64_t position);

 private:
    void get(void* to, std::size_t bytes) override;
    void pass(std::uint64_t bytes) override;
    [[noreturn]] void tooShort() const override;

    std::FILE* file_;
    std::uint64_t bytes_ = 0;
};

/** Part of a file that had to be unpacked first; empty until it is filled. */
class MemoryInput : public ByteInput {
 public:
    std::vector<std::uint8_t>& bytes() { return bytes_; }
    Bytes view(std::vector<std::uint8_t>& buffer, std::uint64_t bytes) override;
    /** Reads bytes() from their begin. */
    void rewind() { start(bytes_.size()); }
    void clear() { start(0); }

 private:
    void get(void* to, std::size_t bytes) override;
    void pass(std::uint64_t) override {}
    [[noreturn]] void tooShort() const override;

    std::vector<std::uint8_t> bytes_;
};

/** Unpacks `packed`, which is a whole bz2 stream ("bz2"), LZ4 frame ("lz4") or zstd frame ("zstd"),
 *  into `out`. `size`: decompressed size according to the bag, at most kMostBytes; memory grows
 *  with the actual data. Throws Error for any other compression, damaged or cut data, and a wrong
 *  size. */
void unpack(const std::string& compression, const std::vector<std::uint8_t>& packed,
            std::uint64_t size, std::vector<std::uint8_t>& out);
}  // namespace delio::io
