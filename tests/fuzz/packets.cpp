#include <algorithm>

#include "recordings/packet_decoder.h"
#include "target.h"

/** Packets of spinning LiDARs, which tell their sensor: each behind a byte that says how long after
 *  the last one it came, and two with its length. In front of a zero byte, a table of angles. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio;
    constexpr std::size_t kHead = 3;
    fuzz::Input input(data, size);
    const bool hasTable = input.pick(2) == 1;
    const std::string table = input.cutText();
    const std::string packets = input.rest();
    const auto* at = reinterpret_cast<const std::uint8_t*>(packets.data());
    std::size_t left = packets.size();
    return fuzz::mayRefuse([&] {
        const auto decoder =
            io::recognisingDecoder(hasTable ? fuzz::fileOf(table, "angles.csv") : "");
        double time_s = 1.7e9;
        while (left > kHead) {
            time_s += 1e-3 * at[0];
            const std::size_t bytes = std::min<std::size_t>(at[1] | at[2] << 8, left - kHead);
            // Reads behind the packet are found where it has memory of its own.
            const std::vector<std::uint8_t> packet(at + kHead, at + kHead + bytes);
            decoder->add(packet.data(), packet.size(), time_s);
            while (decoder->take()) {
            }
            at += kHead + bytes;
            left -= kHead + bytes;
        }
        decoder->finish();
        while (decoder->take()) {
        }
        decoder->findings();
    });
}
