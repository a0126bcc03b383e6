#include "scan_spool.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "delio/core/error.h"

namespace delio::map {
ScanSpool::ScanSpool(const std::string& folder) : folder_(folder) {
    std::string name = folder + "/.partial-scans-XXXXXX";
    const int descriptor = mkstemp(name.data());
    if (descriptor >= 0) {
        unlink(name.c_str());
        file_.reset(fdopen(descriptor, "w+b"));
    }
    if (!file_)
        throw Error("cannot put keyframes aside in '" + folder + "': " + std::strerror(errno));
}

ScanSpool::Place ScanSpool::append(const Floats& cloud) {
    const Place place{end_, cloud.size()};
    const bool written =
        std::fseek(file_.get(), static_cast<long>(end_), SEEK_SET) == 0 &&
        std::fwrite(cloud.data(), sizeof(float), cloud.size(), file_.get()) == cloud.size() &&
        std::fflush(file_.get()) == 0;
    if (!written)
        throw Error("cannot put keyframes aside in '" + folder_ + "': " + std::strerror(errno) +
                    "; make room there, or do without the map (--no-map)");
    end_ += cloud.size() * sizeof(float);
    return place;
}

ScanSpool::Floats ScanSpool::read(const Place& place) const {
    Floats cloud(place.floats);
    if (std::fseek(file_.get(), static_cast<long>(place.offset), SEEK_SET) != 0 ||
        std::fread(cloud.data(), sizeof(float), cloud.size(), file_.get()) != cloud.size())
        throw Error("cannot read the keyframes that were put aside in '" + folder_ + "'");
    return cloud;
}
}  // namespace delio::map
