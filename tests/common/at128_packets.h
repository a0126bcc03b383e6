#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "pcap_writer.h"

/** A Hesai AT128 whose every point is known. */
namespace delio::test {
constexpr std::size_t kAt128Rows = 128;

inline std::string rawAngle(std::int32_t number) {
    return std::string(reinterpret_cast<const char*>(&number), sizeof(number));
}

/** Three fields that begin at 20, 140 and 260 deg; angles in 2/25600 deg. Laser 5 has corrections:
 *  0.04 deg across and -0.02 deg up at even tens of degrees of the mirror, and none 2 deg away. */
inline std::string at128File() {
    std::string text{"\xEE\xFF\x01\x05\x80\x03\x03", 7};
    text += std::string(8, '\0') + '\x02';
    for (const int begin : {20, 140, 260}) text += rawAngle(begin * 12800);
    for (const int end : {140, 260, 20}) text += rawAngle(end * 12800);
    for (std::size_t laser = 0; laser < kAt128Rows; ++laser)
        text += rawAngle(static_cast<std::int32_t>(laser % 8) * 1280 - 4480);
    for (std::size_t laser = 0; laser < kAt128Rows; ++laser)
        text += rawAngle(160000 - static_cast<std::int32_t>(laser) * 2560);
    for (const char correction : {'\x02', '\xFF'})
        for (std::size_t laser = 0; laser < kAt128Rows; ++laser)
            for (int step = 0; step < 180; ++step)
                text += laser == 5 && step % 5 == 0 ? correction : '\0';
    return text + std::string(32, '\0');
}

inline double at128Across(std::size_t laser) {
    return -(static_cast<double>(laser % 8) * 0.1 - 0.35);
}
inline double at128Up(std::size_t laser) { return 12.5 - 0.2 * static_cast<double>(laser); }

inline int at128Distance(std::size_t laser, int shot) {
    return 3000 + 10 * static_cast<int>(laser) + shot % 100;
}

/** Two azimuths, of the `shot`-th one of its field and of the next. */
inline Bytes at128Packet(int field, int shot, double clock_s, std::uint8_t mode = 0x37) {
    Bytes packet(1086);
    const Bytes head{0xEE, 0xFF, 4, 3, 0, 0, 128, 2, 0, 4, 0, 1};
    std::copy(head.begin(), head.end(), packet.begin());
    for (int b = 0; b < 2; ++b) {
        const std::size_t block = 12 + 515 * static_cast<std::size_t>(b);
        const int own = mode == 0x37 ? shot + b : shot;
        // Beams sweep from 30 to 150 deg, the mirror by half of that.
        const int fine = (20 + 120 * field + 15) * 25600 + own * 1280;
        putAt(packet, block, static_cast<std::uint16_t>(fine / 256 % 36000));
        packet[block + 2] = static_cast<std::uint8_t>(fine % 256);
        for (std::size_t laser = 0; laser < kAt128Rows; ++laser) {
            putAt(packet, block + 3 + 4 * laser,
                  static_cast<std::uint16_t>(at128Distance(laser, own) +
                                             (mode == 0x37 ? 0 : 500 * b)));
            packet[block + 5 + 4 * laser] = static_cast<std::uint8_t>(laser);
        }
    }
    const double whole = std::floor(clock_s);
    putAt(packet, 1066, static_cast<std::uint32_t>(std::lround(1e6 * (clock_s - whole))));
    packet[1070] = mode;
    const auto seconds = static_cast<std::uint64_t>(whole);
    for (std::size_t i = 0; i < 5; ++i)
        packet[1073 + i] = static_cast<std::uint8_t>(seconds >> 8 * (4 - i));
    return packet;
}
}  // namespace delio::test
