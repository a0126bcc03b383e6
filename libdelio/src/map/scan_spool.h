#pragma once
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace delio::map {
/** Puts clouds aside on the disk, in a file without a name that is gone when this is, whatever ends
 *  the process. */
class ScanSpool {
 public:
    /** Four floats a point: x, y, z, intensity. */
    using Floats = std::vector<float>;
    struct Place {
        std::uint64_t offset = 0;
        std::size_t floats = 0;
    };

    /** The file lies in `folder`. Throws Error if none can be made there. */
    explicit ScanSpool(const std::string& folder);

    /** Throws Error if the disk is full. */
    Place append(const Floats& cloud);

    /** Throws Error if the disk fails. */
    Floats read(const Place& place) const;

 private:
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    std::string folder_;
    std::unique_ptr<std::FILE, Close> file_;
    std::uint64_t end_ = 0;
};
}  // namespace delio::map
