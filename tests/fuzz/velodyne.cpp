#include "recordings/packet_decoder.h"
#include "target.h"

/** A Velodyne's calibration, a zero byte, and its packets: each a byte that says how long after the
 *  last one it came, and 1206 of its own. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio;
    constexpr std::size_t kPacket = 1206;
    fuzz::Input input(data, size);
    const auto kind = input.pick(3);
    const std::string text = input.cutText();
    const std::string packets = input.rest();
    data = reinterpret_cast<const std::uint8_t*>(packets.data());
    size = packets.size();
    return fuzz::mayRefuse([&] {
        const std::string calibration =
            kind == 0 ? "" : fuzz::fileOf(text, kind == 1 ? "sensor.yaml" : "sensor.xml");
        const auto decoder = io::velodyneDecoder(calibration);
        double time_s = 1.7e9;
        for (; size > kPacket; data += kPacket + 1, size -= kPacket + 1) {
            time_s += 1e-3 * *data;
            decoder->add(data + 1, kPacket, time_s);
            while (decoder->take()) {
            }
        }
        decoder->finish();
        while (decoder->take()) {
        }
    });
}
