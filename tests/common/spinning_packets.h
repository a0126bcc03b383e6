#pragma once
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pcap_writer.h"

/** Packets of Hesai and RoboSense sensors whose every point is known. */
namespace delio::test {
/** Where a Hesai's packets have what; places are bytes. */
struct HesaiToy {
    std::string name;
    std::size_t bytes, lasers, blocks, body, azimuthAt, returnBytes;
    std::size_t modeAt, dateAt, clockAt;
    double first_us, next_us;  //!< of the block that the packet's time is of; to the next azimuth
    bool ofLast;
    std::uint8_t mode = 0x37;
    int step = 20;  //!< 0.01 deg
    /** Of sensors whose headers tell them: the byte that names the sensor, the flags of parts. */
    std::uint8_t status = 0, flags = 0;
    std::size_t stateAt = 0;  //!< 0: there is one operational state only
    std::uint8_t state = 2;
    int begin = 0;  //!< first azimuth, 0.01 deg

    std::size_t returns() const { return mode == 0x3D ? 3 : mode == 0x39 ? 2 : 1; }
    std::size_t shots() const { return blocks / returns(); }
    std::size_t blockBytes() const { return azimuthAt + 2 + lasers * returnBytes; }
};

inline std::vector<HesaiToy> hesaiToys() {
    return {{"Pandar40P", 1262, 40, 10, 0, 2, 3, 1254, 1256, 1250, -28.58, 55.56, true},
            {"Pandar64", 1194, 64, 6, 8, 0, 3, 1186, 1188, 1182, -42.58, 55.56, true},
            {"PandarXT-16", 568, 16, 8, 12, 0, 4, 550, 553, 559, 5.632, 50, true},
            {"PandarXT-32", 1080, 32, 8, 12, 0, 4, 1062, 1065, 1071, 5.632, 50, true},
            {"XT32M2X", 820, 32, 6, 12, 0, 4, 802, 805, 811, 5.632, 50, true},
            {"PandarQT", 1072, 64, 4, 12, 0, 4, 1060, 1062, 1056, 25.71, 166.667, false},
            {"QT128C2X", 1095, 128, 2, 12, 0, 4, 1073, 1076, 1082, 9, 111.11, true}};
}

/** Pandar128 and OT128, with functional safety, an IMU and a number in each packet. */
inline HesaiToy hesai128Toy(bool isOt128) {
    HesaiToy toy{isOt128 ? "OT128" : "Pandar128",
                 861,
                 128,
                 2,
                 12,
                 0,
                 3,
                 817,
                 820,
                 826,
                 isOt128 ? 0 : 3.148,
                 55.556,
                 true};
    toy.status = isOt128 ? 128 : 127;
    toy.flags = 7;
    toy.stateAt = 816;
    return toy;
}

/** Distance of a laser's return at an azimuth, in units of the packet. */
using Distances = std::function<int(std::size_t laser, int azimuth, std::size_t turn)>;

inline int usualDistance(std::size_t laser, int azimuth, std::size_t which) {
    return 2000 + 10 * static_cast<int>(laser) + azimuth / 100 + 500 * static_cast<int>(which);
}

/** The packet that begins `shot` azimuths after 0; its clock says `clock_s` (Unix). */
inline Bytes hesaiPacket(const HesaiToy& toy, std::size_t shot, double clock_s,
                         const Distances& distance = usualDistance) {
    Bytes packet(toy.bytes);
    const bool isShort = toy.body == 8;
    packet[0] = toy.body == 0 ? 0xFF : 0xEE;
    packet[1] = toy.body == 0 ? 0xEE : 0xFF;
    if (toy.body > 0) {
        packet[isShort ? 2 : 6] = static_cast<std::uint8_t>(toy.lasers);
        packet[isShort ? 3 : 7] = static_cast<std::uint8_t>(toy.blocks);
        packet[isShort ? 5 : 9] = 4;
    }
    if (toy.stateAt > 0) {
        packet[4] = toy.status;
        packet[11] = toy.flags;
        packet[toy.stateAt] = toy.state;
    }
    for (std::size_t b = 0; b < toy.blocks; ++b) {
        const std::size_t block = toy.body + b * toy.blockBytes();
        const auto azimuth = static_cast<std::uint16_t>(
            (toy.begin + toy.step * static_cast<int>(shot + b / toy.returns())) % 36000);
        if (toy.azimuthAt == 2) putAt<std::uint16_t>(packet, block, 0xEEFF);
        putAt(packet, block + toy.azimuthAt, azimuth);
        for (std::size_t laser = 0; laser < toy.lasers; ++laser) {
            const std::size_t at = block + toy.azimuthAt + 2 + laser * toy.returnBytes;
            putAt(packet, at,
                  static_cast<std::uint16_t>(distance(laser, azimuth, b % toy.returns())));
            packet[at + 2] = static_cast<std::uint8_t>(laser);
        }
    }
    packet[toy.modeAt] = toy.mode;
    // Of 14 November 2023, 22 h.
    const auto seconds = static_cast<int>(std::floor(clock_s - 1700000000)) + 800;
    const std::uint8_t date[] = {123,
                                 11,
                                 14,
                                 22,
                                 static_cast<std::uint8_t>(seconds / 60),
                                 static_cast<std::uint8_t>(seconds % 60)};
    for (std::size_t i = 0; i < 6; ++i) packet[toy.dateAt + i] = date[i];
    putAt(packet, toy.clockAt,
          static_cast<std::uint32_t>(std::lround(1e6 * (clock_s - std::floor(clock_s)))));
    return packet;
}

/** Packets of `turns` turns from azimuth 0 on, one after the other. */
struct TimedPacket {
    Bytes bytes;
    double time_s;
};
inline std::vector<TimedPacket> hesaiDrive(const HesaiToy& toy, double turns,
                                           double begin_s = 1700000000,
                                           const Distances& distance = usualDistance) {
    std::vector<TimedPacket> packets;
    const auto all = static_cast<std::size_t>(turns * 36000 / toy.step);
    for (std::size_t shot = 0; shot < all; shot += toy.shots()) {
        const double time_s = begin_s + 1e-6 * toy.next_us * static_cast<double>(shot);
        packets.push_back({hesaiPacket(toy, shot, time_s, distance), time_s});
    }
    return packets;
}

/** A RoboSense: Helios, Bpearl or Ruby Plus. */
struct RobosenseToy {
    std::string name;
    std::size_t lasers, blocks, body, blockBytes, clockAt;
    double unit_m, lens_m, height_m, shot_us;
    std::size_t returns = 1;
    int step = 20;

    std::size_t shots() const { return blocks / returns; }
    bool isBpearl() const { return name.find("Bpearl") == 0; }
};

inline std::vector<RobosenseToy> robosenseToys() {
    return {{"Helios", 32, 12, 42, 100, 20, 0.0025, 0.03498, 0, 55.56},
            {"Bpearl", 32, 12, 42, 100, 20, 0.005, 0.01473, 0.09427, 55.52},
            {"Bpearl 4.0", 32, 12, 42, 100, 20, 0.0025, 0.01619, 0.09571, 55.56},
            {"Ruby Plus", 128, 3, 80, 388, 10, 0.005, 0.02892, 0, 55.56}};
}

inline void putBig(Bytes& bytes, std::size_t at, std::uint64_t number, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        bytes[at + i] = static_cast<std::uint8_t>(number >> (8 * (count - 1 - i)));
}

inline Bytes robosensePacket(const RobosenseToy& toy, std::size_t shot, double clock_s,
                             const Distances& distance = usualDistance) {
    Bytes packet(1248);
    const Bytes old{0x55, 0xAA, 0x05, 0x0A, 0x5A, 0xA5, 0x50, 0xA0}, later{0x55, 0xAA, 0x05, 0x5A};
    const Bytes& mark = toy.isBpearl() ? old : later;
    std::copy(mark.begin(), mark.end(), packet.begin());
    const auto whole = static_cast<std::uint64_t>(clock_s);
    const auto us =
        static_cast<std::uint64_t>(std::lround(1e6 * (clock_s - static_cast<double>(whole))));
    if (toy.name == "Bpearl") {
        packet[30] = 3;
        // Of 14 November 2023, 22 h.
        const std::uint64_t seconds = whole - 1700000000 + 800;
        const Bytes date{23,
                         11,
                         14,
                         22,
                         static_cast<std::uint8_t>(seconds / 60),
                         static_cast<std::uint8_t>(seconds % 60)};
        std::copy(date.begin(), date.end(), packet.begin() + 20);
        putBig(packet, 26, us / 1000, 2);
        putBig(packet, 28, us % 1000, 2);
    } else {
        packet[31] = 3;
        packet[32] = 4;
        putBig(packet, toy.clockAt, whole, 6);
        putBig(packet, toy.clockAt + 6, us, 4);
    }
    if (toy.name == "Helios") packet[17] = 1;  // 2.5 mm
    for (std::size_t b = 0; b < toy.blocks; ++b) {
        const std::size_t block = toy.body + b * toy.blockBytes;
        const int azimuth = toy.step * static_cast<int>(shot + b / toy.returns) % 36000;
        packet[block] = toy.lasers == 128 ? 0xFE : 0xFF;
        packet[block + 1] = toy.lasers == 128 ? 0 : 0xEE;
        putBig(packet, block + 2, static_cast<std::uint64_t>(azimuth), 2);
        for (std::size_t laser = 0; laser < toy.lasers; ++laser) {
            const std::size_t at = block + 4 + 3 * laser;
            putBig(packet, at,
                   static_cast<std::uint64_t>(distance(laser, azimuth, b % toy.returns)), 2);
            packet[at + 2] = static_cast<std::uint8_t>(laser);
        }
    }
    return packet;
}

inline std::vector<TimedPacket> robosenseDrive(const RobosenseToy& toy, double turns,
                                               double begin_s = 1700000000,
                                               const Distances& distance = usualDistance) {
    std::vector<TimedPacket> packets;
    const auto all = static_cast<std::size_t>(turns * 36000 / toy.step);
    for (std::size_t shot = 0; shot < all; shot += toy.shots()) {
        const double time_s = begin_s + 1e-6 * toy.shot_us * static_cast<double>(shot);
        packets.push_back({robosensePacket(toy, shot, time_s, distance), time_s});
    }
    return packets;
}

/** Angles that the toys have, degrees. */
inline double toyElevation(std::size_t laser) { return -10 + 0.25 * static_cast<double>(laser); }
inline double toyAzimuth(std::size_t laser) { return static_cast<double>(laser % 4) - 1.5; }

/** A description (DIFOP) with them. */
inline Bytes robosenseDescription(const RobosenseToy& toy) {
    Bytes packet(1248);
    const Bytes mark{0xA5, 0xFF, 0x00, 0x5A, 0x11, 0x11, 0x55, 0x55};
    std::copy(mark.begin(), mark.end(), packet.begin());
    const auto put = [&](std::size_t at, double angle) {
        packet[at] = angle < 0 ? 1 : 0;
        putBig(packet, at + 1, static_cast<std::uint64_t>(std::lround(100 * std::abs(angle))), 2);
    };
    for (std::size_t laser = 0; laser < toy.lasers; ++laser) {
        put(468 + 3 * laser, toyElevation(laser));
        put(468 + 3 * toy.lasers + 3 * laser, toyAzimuth(laser));
    }
    return packet;
}

/** The same as a table with `columns` columns. */
inline std::string toyAngles(std::size_t lasers, int columns = 3) {
    std::string text = columns == 3 ? "Channel,Elevation,Azimuth\n" : "";
    for (std::size_t laser = 0; laser < lasers; ++laser)
        text += (columns == 3 ? std::to_string(laser + 1) + "," : "") +
                std::to_string(toyElevation(laser)) + "," + std::to_string(toyAzimuth(laser)) +
                "\n";
    return text;
}
}  // namespace delio::test
