#include "spool.h"

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

Spool::Place Spool::append(const float* floats, std::size_t count) {
    const Place place{end_, count};
    if (count == 0) return place;
    const bool written = std::fseek(file_.get(), static_cast<long>(end_), SEEK_SET) == 0 &&
                         std::fwrite(floats, sizeof(float), count, file_.get()) == count &&
                         std::fflush(file_.get()) == 0;
    if (!written)
        throw Error("cannot put " + what_ + " aside in '" + folder_ + "': " + std::strerror(errno) +
                    "; free some space there or leave them out (" + option_ + ")");
    end_ += count * sizeof(float);
    return place;
}

Spool::Floats Spool::read(const Place& place) const {
    Floats cloud(place.floats);
    if (cloud.empty()) return cloud;
    if (std::fseek(file_.get(), static_cast<long>(place.offset), SEEK_SET) != 0 ||
        std::fread(cloud.data(), sizeof(float), cloud.size(), file_.get()) != cloud.size())
        throw Error("cannot read the " + what_ + " from the temporary file in '" + folder_ + "'");
    return cloud;
}
}  // namespace delio::io
