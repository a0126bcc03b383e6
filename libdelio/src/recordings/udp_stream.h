#pragma once
#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "packet_source.h"

struct pcap;

namespace delio::io {
/** Puts the fragments of IPv4 datagrams together, in whatever order they come. Datagrams that lack
 *  one are forgotten when there are too many of them: memory is bounded. */
class IpFragments {
 public:
    /** Source, destination, identification and protocol: fragments that share it belong together.
     */
    using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint16_t, std::uint8_t>;

    /** A fragment `offset` bytes into the datagram; `last`: none follows it. Gives the datagram's
     *  content when that was the one that was missing. */
    std::optional<std::vector<std::uint8_t>> add(const Key& key, std::size_t offset, bool last,
                                                 const std::uint8_t* bytes, std::size_t count);

 private:
    struct Datagram {
        Key key;
        std::map<std::size_t, std::vector<std::uint8_t>> parts;
        std::size_t size = 0;  //!< 0: its end was not met yet
        std::size_t held = 0;  //!< bytes that came of it, again and again
    };
    static bool complete(const Datagram& datagram);

    std::list<Datagram> open_;
};

/** The UDP datagrams, over IPv4, of a pcap or pcapng: of Ethernet (VLANs as well), Linux' cooked
 *  capture, the loopback or raw IP. Fragments are put together; other packets, and those that the
 *  recorder kept a part of, are passed over. */
class UdpStream : public PacketSource {
 public:
    /** "-": standard input. Throws Error where it cannot be opened or is not a pcap. */
    explicit UdpStream(const std::string& path);

    /** Nothing at the end. Throws Error, which names the file, where it is cut off or damaged. */
    std::optional<UdpPacket> next() override;

    /** Part of the file that was read, 0 to 1; nothing for standard input. */
    std::optional<double> fraction() const override;

 private:
    struct View;
    /** IPv4 payload of an Ethernet-like frame. */
    std::optional<View> ipOf(const View& frame) const;
    std::optional<UdpPacket> udpOf(const View& ip);

    std::string path_;
    std::shared_ptr<pcap> pcap_;
    int linkType_ = 0;
    double size_ = 0;
    IpFragments fragments_;
    std::vector<std::uint8_t> whole_;  //!< the datagram that was put together last
};
}  // namespace delio::io
