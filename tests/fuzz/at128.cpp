#include <vector>

#include "at128_packets.h"
#include "recordings/hesai_at128.h"
#include "target.h"

/** A Hesai AT128: its file of corrections ('1' in front of it), or packets with a good one. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio;
    constexpr std::size_t kPacket = 1086;
    fuzz::Input input(data, size);
    const bool isFile = input.pick(2) == 1;
    const std::string rest = input.rest();
    return fuzz::mayRefuse([&] {
        if (isFile) {
            const io::At128Angles angles(fuzz::fileOf(rest, "angles.dat"));
            std::size_t field = 0;
            for (double mirror = 0; mirror < 360; ++mirror)
                if (angles.withinField(mirror, field) >= 0) angles.direction(field, mirror, 127);
            return;
        }
        const auto decoder = io::hesaiDecoder(fuzz::fileOf(test::at128File(), "good.dat"));
        for (std::size_t at = 0; at + kPacket <= rest.size(); at += kPacket) {
            const std::vector<std::uint8_t> packet(
                rest.begin() + static_cast<std::ptrdiff_t>(at),
                rest.begin() + static_cast<std::ptrdiff_t>(at + kPacket));
            decoder->add(packet.data(), packet.size(), 1.7e9 + 1e-3 * static_cast<double>(at));
            while (decoder->take()) {
            }
        }
        decoder->finish();
        while (decoder->take()) {
        }
    });
}
