#include "ouster_frame.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "turn_times.h"

namespace delio::io {
namespace {
template <typename Number>
Number numberAt(const std::uint8_t* bytes) {
    Number number;
    std::memcpy(&number, bytes, sizeof(number));
    return number;
}
}  // namespace

std::optional<OusterTimes> timesOf(const OusterFrame& frame) {
    constexpr double kTolerance = 0.02;  // real columns are within 0.0005 turns of an even course
    std::vector<double> places, times_s;
    std::vector<std::uint64_t> told_ns;
    for (std::size_t column = 0; column < frame.received.size(); ++column) {
        if (!frame.received[column]) continue;
        places.push_back(static_cast<double>(column) / static_cast<double>(frame.received.size()));
        told_ns.push_back(frame.times_ns[column]);
    }
    if (told_ns.empty()) return {};
    auto sorted = told_ns;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    for (const std::uint64_t time_ns : told_ns)
        times_s.push_back(1e-9 * static_cast<double>(static_cast<std::int64_t>(time_ns - *middle)));
    const auto mended = mendTurnTimes(places, kTolerance, times_s);
    if (!mended) return {};
    const std::int64_t first_ns = std::llround(1e9 * times_s.front());
    OusterTimes times;
    times.start_ns = *middle + static_cast<std::uint64_t>(first_ns);
    for (const double time_s : times_s)
        times.since_s.push_back(1e-9 * static_cast<double>(std::llround(1e9 * time_s) - first_ns));
    times.mended = *mended;
    return times;
}

OusterIds OusterPacket::ids() const {
    if (info_.layout.legacy) return {};
    constexpr std::uint64_t k24Bits = 0xFFFFFF, k40Bits = 0xFFFFFFFFFF;
    const auto bits = numberAt<std::uint64_t>(bytes_ + 4);
    return {numberAt<std::uint64_t>(bytes_ + 7) & k40Bits,
            static_cast<std::uint32_t>(bits & k24Bits)};
}

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
