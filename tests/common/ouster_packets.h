#pragma once
#include <nlohmann/json.hpp>

#include "pcap_writer.h"

/** An Ouster of 16 rows and 512 columns that sees one range everywhere. */
namespace delio::test {
struct OusterToy {
    std::string profile = "RNG19_RFL8_SIG16_NIR16";
    std::uint32_t range_mm = 5000;
    std::uint64_t start_ns = 1000000000;  //!< its clock counts from when it was switched on
    std::uint64_t serial = 0;             //!< 0: none
    std::uint32_t initialization = 0;     //!< likewise

    bool legacy() const { return profile == "LEGACY"; }
    bool has(const std::string& part) const { return profile.find(part) != std::string::npos; }
    bool dual() const { return has("DUAL") || profile == "FIVE_WORD_PIXEL"; }
    /** Ranges of 15 bits. */
    bool coarse() const { return has("RNG15"); }
    bool safety() const { return has("FUSA"); }
    std::size_t pixel() const {
        if (coarse()) return dual() || has("ZONE16") ? 8 : 4;
        return (dual() ? 16 : 12) + (has("RGB16") || profile == "FIVE_WORD_PIXEL" ? 4 : 0);
    }

    nlohmann::json json() const {
        std::vector<double> up, azimuths;
        for (int row = 0; row < 16; ++row) {
            up.push_back(15 - 2 * row);
            azimuths.push_back(row % 2 ? 3 : -3);
        }
        nlohmann::json json{
            {"beam_altitude_angles", up},
            {"beam_azimuth_angles", azimuths},
            {"lidar_origin_to_beam_origin_mm", 20},
            {"lidar_to_sensor_transform", {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 36, 0, 0, 0, 1}},
            {"prod_line", "OS-1-16"},
            {"lidar_mode", "512x10"},
            {"data_format",
             {{"columns_per_frame", 512},
              {"columns_per_packet", 16},
              {"pixels_per_column", 16},
              {"udp_profile_lidar", profile}}}};
        if (serial > 0) json["prod_sn"] = std::to_string(serial);
        if (initialization > 0) json["initialization_id"] = initialization;
        return json;
    }

    /** Packet `i` of turn `frame`, 32 a turn, with reflectivity 51 everywhere. */
    Bytes packet(std::uint16_t frame, std::size_t i) const {
        const std::size_t head = legacy() ? 0 : 32, columnHead = legacy() ? 16 : 12;
        const std::size_t column = columnHead + 16 * pixel() + (legacy() ? 4 : 0);
        Bytes bytes(2 * head + 16 * column);
        if (!legacy()) {
            putAt(bytes, safety() ? 4 : 2, frame);
            putAt(bytes, safety() ? 1 : 4, initialization);  // 24 bits
            for (std::size_t byte = 0; byte < 5; ++byte)
                bytes[(safety() ? 11 : 7) + byte] = static_cast<std::uint8_t>(serial >> 8 * byte);
            if (safety()) {
                bytes[0] = 1;
                putAt(bytes, 4, std::uint32_t{frame});
            }
        }
        for (std::size_t c = 0; c < 16; ++c) {
            const std::size_t at = head + c * column;
            const auto place = static_cast<std::uint16_t>(16 * i + c);
            putAt(bytes, at, start_ns + (512ULL * frame + place) * 195312);
            putAt(bytes, at + 8, place);
            putAt(bytes, at + 10, legacy() ? frame : std::uint16_t{1});
            if (legacy()) putAt(bytes, at + column - 4, 0xFFFFFFFFU);
            for (std::size_t row = 0; row < 16; ++row)
                putPixel(bytes, at + columnHead + row * pixel());
        }
        return bytes;
    }

    void putPixel(Bytes& bytes, std::size_t at) const {
        if (coarse()) {
            putAt(bytes, at, static_cast<std::uint16_t>(0x8000U | range_mm / 8));
            bytes[at + 2] = 51;
            if (dual()) putAt<std::uint16_t>(bytes, at + 4, 7777);
        } else {
            putAt(bytes, at, legacy() ? range_mm : range_mm | 0x80000U);
            bytes[at + (pixel() > 12 ? 3 : 4)] = 51;
            if (dual()) putAt(bytes, at + 4, 7777U);  // the second return
        }
    }
};
}  // namespace delio::test
