#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>

namespace delio::io {
/** Content of one UDP datagram; valid until the next one is read. */
struct UdpPacket {
    const std::uint8_t* payload = nullptr;
    std::size_t bytes = 0;
    std::uint32_t from = 0;  //!< IPv4 address of the sender
    std::uint16_t fromPort = 0;
    std::uint16_t toPort = 0;
    double time_s = 0;  //!< Unix time at which it was recorded
};

/** UDP datagrams in the order in which they came. */
class PacketSource {
 public:
    PacketSource() = default;
    virtual ~PacketSource() = default;
    PacketSource(const PacketSource&) = delete;
    PacketSource& operator=(const PacketSource&) = delete;

    /** Nothing at the end. Throws Error, which names the source, where it is damaged. */
    virtual std::optional<UdpPacket> next() = 0;

    /** Part that was read, 0 to 1; nothing where that is not known. */
    virtual std::optional<double> fraction() const { return {}; }

    /** The packets come from a sensor now, not from a recording. */
    virtual bool isLive() const { return false; }

    /** Takes note that the last packet of this scan came at `last_s` (Unix). */
    virtual void endScan(std::size_t /*index*/, double /*last_s*/) {}
};
}  // namespace delio::io
