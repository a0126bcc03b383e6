#pragma once
#include <cstdint>
#include <string>

namespace delio::io {
/** The metadata json that an Ouster gives away by HTTP; waits three seconds for it at most.
 *  `address`: its IPv4 address; `port`: 80, but for tests. Throws Error where it cannot be had. */
std::string ousterJsonFrom(std::uint32_t address, std::uint16_t port);
}  // namespace delio::io
