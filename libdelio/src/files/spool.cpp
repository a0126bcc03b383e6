#include "spool.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "delio/core/error.h"

namespace delio::io {
Spool::Spool(const std::string& folder, std::string what, std::string option)
    : folder_(folder.empty() ? std::filesystem::temp_directory_path().string() : folder),
      what_(std::move(what)),
      option_(std::move(option)) {
    std::string name = folder_ + "/.partial-scans-XXXXXX";
    const int descriptor = mkstemp(name.data());
    if (descriptor >= 0) {
        unlink(name.c_str());
        file_.reset(fdopen(descriptor, "w+b"));
    }
    if (!file_)
        throw Error("cannot put " + what_ + " aside in '" + folder_ + "': " + std::strerror(errno));
}

Spool::Spool(std::string folder, std::string path, std::string what, std::string option, int flags)
    : folder_(std::move(folder)),
      path_(std::move(path)),
      what_(std::move(what)),
      option_(std::move(option)) {
    constexpr mode_t kMode = 0644;
    const int descriptor = open(path_.c_str(), O_RDWR | O_CLOEXEC | flags, kMode);
    if (descriptor >= 0) file_.reset(fdopen(descriptor, "r+b"));
}

Spool Spool::named(const std::string& path, std::string what, std::string option) {
    const std::string folder = std::filesystem::path(path).parent_path().string();
    Spool spool(folder, path, std::move(what), std::move(option), O_CREAT | O_TRUNC);
    if (!spool.file_)
        throw Error("cannot put " + spool.what_ + " aside in '" + path +
                    "': " + std::strerror(errno));
    return spool;
}

Spool Spool::again(const std::string& path, std::string what, std::string option,
                   std::uint64_t end) {
    const std::string folder = std::filesystem::path(path).parent_path().string();
    Spool spool(folder, path, std::move(what), std::move(option), 0);
    std::error_code error;
    const std::uint64_t size = spool.file_ ? std::filesystem::file_size(path, error) : 0;
    if (!spool.file_ || error || size < end)
        throw Error("'" + path + "', where the " + spool.what_ + " of the drive were put aside, " +
                    (spool.file_ ? "is cut off" : "cannot be opened") + ": begin the drive again");
    std::filesystem::resize_file(path, end);
    spool.end_ = spool.kept_ = end;
    return spool;
}

std::uint64_t Spool::kept() const {
    if (path_.empty())
        throw Error("the " + what_ +
                    " are put aside in a file without a name, which cannot be kept");
    if (kept_ != end_ && fdatasync(fileno(file_.get())) != 0)  // append() has flushed
        throw Error("cannot keep the " + what_ + " in '" + path_ + "': " + std::strerror(errno));
    kept_ = end_;
    return end_;
}

Spool::Place Spool::append(const float* floats, std::size_t count) {
    const Place place{end_, count};
    if (count == 0) return place;
    const bool written = std::fseek(file_.get(), static_cast<long>(end_), SEEK_SET) == 0 &&
                         std::fwrite(floats, sizeof(float), count, file_.get()) == count &&
                         std::fflush(file_.get()) == 0;
    if (!written)
        throw Error("cannot put " + what_ + " aside in '" + folder_ + "': " + std::strerror(errno) +
                    "; make room there, or do without them (" + option_ + ")");
    end_ += count * sizeof(float);
    return place;
}

Spool::Floats Spool::read(const Place& place) const {
    Floats cloud(place.floats);
    if (cloud.empty()) return cloud;
    if (std::fseek(file_.get(), static_cast<long>(place.offset), SEEK_SET) != 0 ||
        std::fread(cloud.data(), sizeof(float), cloud.size(), file_.get()) != cloud.size())
        throw Error("cannot read the " + what_ + " that were put aside in '" + folder_ + "'");
    return cloud;
}
}  // namespace delio::io
