#pragma once
#include <cstddef>
#include <cstdint>

namespace delio::io {
/** True for a packet of a RoboSense: of measurements (MSOP) or of the sensor's description
 *  (DIFOP). */
bool isRobosensePacket(const std::uint8_t* packet, std::size_t bytes);
/** True for the latter, which holds the angles of the beams, and comes to another port. */
bool describesRobosense(const std::uint8_t* packet, std::size_t bytes);
}  // namespace delio::io
