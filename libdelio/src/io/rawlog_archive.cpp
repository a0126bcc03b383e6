#include "rawlog_archive.h"

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string_view>

namespace delio::io {
namespace {
bool isNameOfCloud(const void* data, std::size_t count) {
    constexpr std::string_view kBegin = "mrpt::maps::C";
    const std::string_view name(static_cast<const char*>(data), count);
    return name.substr(0, kBegin.size()) == kBegin &&
           name.find("PointsMap") != std::string_view::npos;
}
}  // namespace

std::size_t RawlogArchive::read(void* data, std::size_t count) {
    const std::size_t done = in_.Read(data, count);
    if (next_ == Next::Version && count == 1) {
        next_ = Next::Points;
        return done;
    }
    if (next_ == Next::Points && count == sizeof(std::uint32_t)) checkPoints(data);
    next_ = isNameOfCloud(data, done) ? Next::Version : Next::Anything;
    return done;
}

void RawlogArchive::checkPoints(const void* data) const {
    std::uint32_t points = 0;
    std::memcpy(&points, data, sizeof(points));
    constexpr std::uint64_t kBytesOfPoint = 3 * sizeof(float), kMost = 100'000'000;
    const std::uint64_t left = in_.getTotalBytesCount() - in_.getPosition();
    if (points > (in_.compressed() ? kMost : left / kBytesOfPoint))
        throw std::length_error("a cloud claims more points than the file can hold");
}
}  // namespace delio::io
