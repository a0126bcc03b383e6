#pragma once
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace delio::io {
/** Puts clouds aside in an unlinked temporary file, which is gone when this is, whatever ends the
 *  process. */
class Spool {
 public:
    using Floats = std::vector<float>;
    struct Place {
        std::uint64_t offset = 0;
        std::size_t floats = 0;
    };

    /** The file lies in `folder` (empty: the system's for temporary files). `what` is put aside,
     *  and `option` is how to do without, for messages. Throws Error if none can be made there. */
    Spool(const std::string& folder, std::string what, std::string option);

    /** Throws Error if the disk is full. */
    Place append(const float* floats, std::size_t count);
    Place append(const Floats& cloud) { return append(cloud.data(), cloud.size()); }

    /** Throws Error if the disk fails. */
    Floats read(const Place& place) const;

 private:
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    std::string folder_, what_, option_;
    std::unique_ptr<std::FILE, Close> file_;
    std::uint64_t end_ = 0;
};
}  // namespace delio::io
