#pragma once
#include <mrpt/io/CStream.h>
#include <cstdint>
#include <string>
#include <vector>

struct gzFile_s;

namespace delio::io {
/** A file to read, plain or compressed with gzip. MRPT's CFileGZInputStream takes zlib's error code
 *  for a number of bytes read, and its archives take a short read for a whole one: here both
 *  throw, so that no object is made of bytes that are not in the file. */
class GzInput : public mrpt::io::CStream {
 public:
    /** Path "-": standard input. Throws Error if the file cannot be opened. */
    explicit GzInput(const std::string& path);
    ~GzInput() override;
    GzInput(const GzInput&) = delete;
    GzInput& operator=(const GzInput&) = delete;

    /** Reads `count` bytes; returns 0 if none is left, and throws std::runtime_error if fewer are,
     *  or if the compressed data is cut off or damaged. */
    std::size_t Read(void* buffer, std::size_t count) override;

    /** Reads what is left, until there were more than `most` bytes in all; throws as Read() does.
     */
    void skipToEnd(std::uint64_t most);

    /** True once nothing is left and all of the compressed data, its checksum included, was right.
     */
    bool endedWell() const;

    /** Or a stream: what is left in it is not known. */
    bool compressed() const;
    /** Position in the decompressed data; in an uncompressed file the file position. */
    std::uint64_t getPosition() const override;
    /** Bytes of the file. */
    std::uint64_t getTotalBytesCount() const override { return size_; }

    /** Not available: these throw. */
    std::size_t Write(const void* buffer, std::size_t count) override;
    std::uint64_t Seek(std::int64_t offset, TSeekOrigin origin) override;

 private:
    std::size_t readSome(void* buffer, std::size_t count);
    std::size_t readPlain(void* buffer, std::size_t count);

    gzFile_s* file_ = nullptr;
    /** Standard input. Where it is not compressed, zlib has no part in it: it waits until its
     * buffer is full, and so delays what a sensor sends. */
    int input_ = -1;
    std::vector<char> buffer_;               //!< of that
    std::size_t buffered_ = 0, taken_ = 0;   //!< bytes in the buffer
    std::uint64_t size_ = 0, position_ = 0;  //!< position: of that
    bool ended_ = false;
};

/** Bytes that a file unpacks to; its size if it is not compressed. Throws std::runtime_error where
 *  its compressed data is cut off or damaged, and Error if it cannot be opened or is larger than
 *  kMostBytes. */
std::uint64_t unpackedSize(const std::string& path);

/** A file to write, compressed with gzip as MRPT does it. MRPT's CFileGZOutputStream says nothing
 *  where the disk is full by the time it closes the file: here close() does. */
class GzOutput : public mrpt::io::CStream {
 public:
    /** Throws Error if the file cannot be opened. */
    explicit GzOutput(const std::string& path);
    ~GzOutput() override;
    GzOutput(const GzOutput&) = delete;
    GzOutput& operator=(const GzOutput&) = delete;

    /** Throws std::runtime_error if the disk is full. */
    std::size_t Write(const void* buffer, std::size_t count) override;

    /** False if not everything is on the disk. */
    bool close();

    std::uint64_t getPosition() const override;
    std::uint64_t getTotalBytesCount() const override { return getPosition(); }

    /** Not available: these throw. */
    std::size_t Read(void* buffer, std::size_t count) override;
    std::uint64_t Seek(std::int64_t offset, TSeekOrigin origin) override;

 private:
    gzFile_s* file_;
};
}  // namespace delio::io
