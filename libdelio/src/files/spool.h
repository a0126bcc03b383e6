#pragma once
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace delio::io {
/** Puts clouds aside on the disk: in a file without a name that is gone when this is, whatever ends
 *  the process; or in one that stays, for who wants to go on later. */
class Spool {
 public:
    using Floats = std::vector<float>;
    struct Place {
        std::uint64_t offset = 0;
        std::size_t floats = 0;

        template <class Archive>
        void serialize(Archive& archive) {
            archive(offset, floats);
        }
    };

    /** The file lies in `folder` (empty: the system's for temporary files). `what` is put aside,
     *  and `option` is how to do without, for messages. Throws Error if none can be made there. */
    Spool(const std::string& folder, std::string what, std::string option);

    /** In the file `path`, which stays; what was in it is gone. Error if it cannot be made. */
    static Spool named(const std::string& path, std::string what, std::string option);
    /** What named() made, once more, as it was when kept() told its `end`: what came after that is
     *  gone. Error where the file is missing, or shorter. */
    static Spool again(const std::string& path, std::string what, std::string option,
                       std::uint64_t end);
    /** Where it ends, in bytes; all before that is on the disk to stay. Error where the disk fails,
     *  or the file has no name. */
    std::uint64_t kept() const;

    /** Throws Error if the disk is full. */
    Place append(const float* floats, std::size_t count);
    Place append(const Floats& cloud) { return append(cloud.data(), cloud.size()); }

    /** Throws Error if the disk fails. */
    Floats read(const Place& place) const;

 private:
    Spool(std::string folder, std::string path, std::string what, std::string option, int flags);

    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    std::string folder_, path_, what_, option_;  //!< no path: a file without a name
    std::unique_ptr<std::FILE, Close> file_;
    std::uint64_t end_ = 0;
    mutable std::uint64_t kept_ = 0;  //!< so much of it is on the disk to stay
};
}  // namespace delio::io
