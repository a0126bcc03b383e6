#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "packet_decoder.h"

namespace delio::io {
constexpr std::size_t kAt128Lasers = 128;

/** An AT128's own angles, which its file of corrections holds. A turn of its mirror has several
 *  fields, in each of which the lasers sweep over the same directions. */
class At128Angles {
 public:
    /** Throws Error, which names the file, for a missing, cut off or unknown one. */
    explicit At128Angles(const std::string& file);

    /** Degrees. */
    struct Direction {
        double azimuth = 0;  //!< clockwise from y
        double elevation = 0;
    };
    /** By the mirror's angle, degrees, 0 or more. The field has to be that of the angle. */
    Direction direction(std::size_t field, double mirror_deg, std::size_t laser) const;
    /** By how far the mirror has turned within its field, degrees; the field in `field`. Negative:
     *  the angle lies in no field. */
    double withinField(double mirror_deg, std::size_t& field) const;

 private:
    std::vector<double> starts_, ends_;  //!< of the fields, degrees
    std::array<Direction, kAt128Lasers> lasers_;
    /** 0.01 deg, every 2 deg of the mirror. */
    std::vector<std::int8_t> moreAzimuth_, moreElevation_;
    double unit_deg_ = 0;
};

/** True where a packet of an AT128 can have so many bytes. */
bool isAt128Size(std::size_t bytes);
bool isAt128(const std::uint8_t* packet, std::size_t bytes);
/** `anglesFile`: as Hesai's tools write it (.dat). */
std::unique_ptr<PacketDecoder> at128Decoder(const std::string& anglesFile);
}  // namespace delio::io
