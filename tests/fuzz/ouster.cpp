#include <algorithm>

#include "recordings/ouster.h"
#include "recordings/packet_decoder.h"
#include "target.h"

/** An Ouster's json, a zero byte, and packets of the size that it says; the last one may be cut
 *  off, and is filled up with zeros. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio;
    fuzz::Input input(data, size);
    return fuzz::mayRefuse([&] {
        const std::string json = input.cutText();
        const auto decoder = io::ousterDecoder(json, "sensor.json");
        const auto info = io::readOusterInfo(json, "sensor.json");
        const std::size_t packet = info.packetBytes(), imu = 164 + 36 * info.imuSamples;
        std::string bytes = input.rest();
        if (packet > 100000) return;  // megabytes of zeros would slow the rest down
        bytes.resize((bytes.size() + packet - 1) / packet * packet);
        for (std::size_t at = 0; at < bytes.size(); at += packet) {
            if (imu <= packet)
                decoder->addImu(reinterpret_cast<const std::uint8_t*>(bytes.data() + at), imu);
            decoder->add(reinterpret_cast<const std::uint8_t*>(bytes.data() + at), packet, 1.7e9);
            while (decoder->take()) {
            }
        }
        decoder->finish();
        while (decoder->take()) {
        }
        decoder->takeImu();
    });
}
