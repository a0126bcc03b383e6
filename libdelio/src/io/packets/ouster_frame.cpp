#include "ouster_frame.h"

#include <algorithm>
#include <cstring>

namespace delio::io {
namespace {
template <typename Number>
Number numberAt(const std::uint8_t* bytes) {
    Number number;
    std::memcpy(&number, bytes, sizeof(number));
    return number;
}
}  // namespace

std::uint64_t OusterPacket::time_ns(std::size_t column) const {
    return numberAt<std::uint64_t>(at(column));
}

std::size_t OusterPacket::place(std::size_t column) const {
    return numberAt<std::uint16_t>(at(column) + 8);
}

std::uint16_t OusterPacket::frameOf(std::size_t column) const {
    return numberAt<std::uint16_t>(info_.layout.legacy ? at(column) + 10 : bytes_ + 2);
}

bool OusterPacket::valid(std::size_t column) const {
    const OusterLayout& layout = info_.layout;
    if (layout.legacy)
        return numberAt<std::uint32_t>(at(column) + info_.columnBytes() - layout.columnFooter) ==
               0xFFFFFFFF;
    return numberAt<std::uint16_t>(at(column) + 10) & 1U;
}

void OusterPacket::copyTo(OusterFrame& frame, std::size_t column) const {
    const OusterLayout& layout = info_.layout;
    const std::size_t to = place(column);
    if (!frame.received[to]) ++frame.count;
    frame.received[to] = true;
    frame.times_ns[to] = time_ns(column);
    const std::uint8_t* pixel = at(column) + layout.columnHeader;
    for (std::size_t i = to * info_.rows; i < (to + 1) * info_.rows; ++i, pixel += layout.pixel) {
        const std::uint32_t range = layout.rangeBytes == 2 ? numberAt<std::uint16_t>(pixel)
                                                           : numberAt<std::uint32_t>(pixel);
        frame.ranges_mm[i] = (range & layout.rangeMask) * layout.rangeUnit_mm;
        const std::uint8_t* const reflectivity = pixel + layout.reflectivityAt;
        frame.reflectivities[i] = layout.reflectivityBytes == 1
                                      ? *reflectivity
                                      : static_cast<std::uint8_t>(std::min<std::uint16_t>(
                                            255, numberAt<std::uint16_t>(reflectivity)));
    }
}
}  // namespace delio::io
