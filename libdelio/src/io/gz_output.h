#pragma once
#include <mrpt/io/CStream.h>

#include <cstdint>
#include <string>

struct gzFile_s;

namespace delio::io {
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
