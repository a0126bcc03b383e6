#include "udp_stream.h"

#include <pcap/pcap.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>

#include "delio/core/error.h"

namespace delio::io {
/** Bytes as they were sent: numbers are big-endian. */
struct UdpStream::View {
    const std::uint8_t* bytes;
    std::size_t count;

    std::uint8_t byte(std::size_t i) const { return bytes[i]; }
    std::uint16_t two(std::size_t i) const {
        return static_cast<std::uint16_t>(bytes[i] << 8 | bytes[i + 1]);
    }
    std::uint32_t four(std::size_t i) const {
        return static_cast<std::uint32_t>(two(i)) << 16 | two(i + 2);
    }
    std::optional<View> from(std::size_t i) const {
        if (i > count) return {};
        return View{bytes + i, count - i};
    }
};

namespace {
constexpr std::uint16_t kIpv4 = 0x0800;
constexpr std::uint8_t kUdp = 17;
constexpr std::size_t kUdpHeader = 8;

bool isVlan(std::uint16_t type) { return type == 0x8100 || type == 0x88A8 || type == 0x9100; }

/** Offset of the protocol field in a link header, and the header's length. */
struct Link {
    int type;
    std::size_t protocolAt, header;
};
constexpr std::array<Link, 3> kLinks{
    {{DLT_EN10MB, 12, 14}, {DLT_LINUX_SLL, 14, 16}, {DLT_LINUX_SLL2, 0, 20}}};

bool isRaw(int type) {
    // Raw IP has another number in the file on some systems.
    constexpr int kRawOfFiles = 101, kRawOfOpenBsd = 14;
    return type == DLT_RAW || type == DLT_IPV4 || type == kRawOfFiles || type == kRawOfOpenBsd;
}

bool isKnown(int type) {
    return isRaw(type) || type == DLT_NULL || type == DLT_LOOP ||
           std::any_of(kLinks.begin(), kLinks.end(),
                       [&](const Link& link) { return link.type == type; });
}

std::string named(const std::string& path) {
    return path == "-" ? "standard input" : "'" + path + "'";
}
}  // namespace

UdpStream::UdpStream(const std::string& path) : path_(path) {
    std::array<char, PCAP_ERRBUF_SIZE> reason{};
    std::FILE* const file = path == "-" ? stdin : std::fopen(path.c_str(), "rb");
    if (!file) throw Error("'" + path + "' cannot be opened");
    pcap_t* const opened =
        pcap_fopen_offline_with_tstamp_precision(file, PCAP_TSTAMP_PRECISION_NANO, reason.data());
    if (!opened) {
        if (file != stdin) std::fclose(file);
        throw Error(named(path) + " is not a pcap or is cut off at its start (" + reason.data() +
                    ")");
    }
    pcap_ = std::shared_ptr<pcap>(opened, pcap_close);
    linkType_ = pcap_datalink(opened);
    if (!isKnown(linkType_)) {
        const char* const name = pcap_datalink_val_to_name(linkType_);
        throw Error(named(path) + ": unsupported link type " +
                    (name ? name : std::to_string(linkType_)) +
                    "; supported are Ethernet, Linux cooked, loopback and raw IP");
    }
    std::error_code none;
    const auto size = path == "-" ? 0 : std::filesystem::file_size(path, none);
    if (!none) size_ = static_cast<double>(size);
}

std::optional<double> UdpStream::fraction() const {
    const long at = size_ > 0 ? std::ftell(pcap_file(pcap_.get())) : -1;
    if (at < 0) return {};
    return std::min(1.0, static_cast<double>(at) / size_);
}

std::optional<UdpPacket> UdpStream::next() {
    constexpr int kRead = 1;
    while (true) {
        pcap_pkthdr* header = nullptr;
        const std::uint8_t* bytes = nullptr;
        const int got = pcap_next_ex(pcap_.get(), &header, &bytes);
        if (got == PCAP_ERROR_BREAK) return {};
        if (got != kRead)
            throw Error(named(path_) + " is cut off or damaged (" + pcap_geterr(pcap_.get()) + ")");
        const auto ip = ipOf({bytes, header->caplen});
        auto packet = ip ? udpOf(*ip) : std::nullopt;
        if (!packet) continue;
        packet->time_s =
            static_cast<double>(header->ts.tv_sec) + 1e-9 * static_cast<double>(header->ts.tv_usec);
        return packet;
    }
}

std::optional<UdpStream::View> UdpStream::ipOf(const View& frame) const {
    if (isRaw(linkType_)) return frame;
    // The family is in the recorder's byte order; a packet of another one has no IPv4 header.
    if (linkType_ == DLT_NULL || linkType_ == DLT_LOOP) return frame.from(4);
    const auto link = std::find_if(kLinks.begin(), kLinks.end(),
                                   [&](const Link& known) { return known.type == linkType_; });
    if (frame.count < link->header) return {};
    std::uint16_t protocol = frame.two(link->protocolAt);
    std::size_t at = link->header;
    while (isVlan(protocol)) {
        if (frame.count < at + 4) return {};
        protocol = frame.two(at + 2);
        at += 4;
    }
    return protocol == kIpv4 ? frame.from(at) : std::nullopt;
}

std::optional<UdpPacket> UdpStream::udpOf(const View& ip) {
    constexpr std::size_t kShortest = 20;
    if (ip.count < kShortest || ip.byte(0) >> 4 != 4 || ip.byte(9) != kUdp) return {};
    const std::size_t header = std::size_t{4} * (ip.byte(0) & 0xFU), total = ip.two(2);
    if (header < kShortest || total < header || total > ip.count) return {};
    View udp{ip.bytes + header, total - header};
    const std::size_t offset = std::size_t{8} * (ip.two(6) & 0x1FFFU);
    const bool more = ip.two(6) & 0x2000U;
    if (offset > 0 || more) {
        auto whole = fragments_.add({ip.four(12), ip.four(16), ip.two(4), kUdp}, offset, !more,
                                    udp.bytes, udp.count);
        if (!whole) return {};
        whole_ = std::move(*whole);
        udp = {whole_.data(), whole_.size()};
    }
    if (udp.count < kUdpHeader) return {};
    const std::size_t length = udp.two(4);
    if (length < kUdpHeader || length > udp.count) return {};
    UdpPacket packet;
    packet.payload = udp.bytes + kUdpHeader;
    packet.bytes = length - kUdpHeader;
    packet.from = ip.four(12);
    packet.fromPort = udp.two(0);
    packet.toPort = udp.two(2);
    return packet;
}

namespace {
constexpr std::size_t kMostOpen = 32;
constexpr std::size_t kLargest = 65535;          // bytes of a datagram
constexpr std::size_t kMostHeld = 4 * kLargest;  // of one, sent again some times
}  // namespace

bool IpFragments::complete(const Datagram& datagram) {
    if (datagram.size == 0) return false;
    std::size_t covered = 0;
    for (const auto& [offset, bytes] : datagram.parts) {
        if (offset > covered) return false;
        covered = std::max(covered, offset + bytes.size());
    }
    return covered >= datagram.size;
}

std::optional<std::vector<std::uint8_t>> IpFragments::add(const Key& key, std::size_t offset,
                                                          bool last, const std::uint8_t* bytes,
                                                          std::size_t count) {
    if (count == 0 || offset + count > kLargest) return {};
    auto found = std::find_if(open_.begin(), open_.end(),
                              [&](const Datagram& datagram) { return datagram.key == key; });
    if (found == open_.end()) {
        if (open_.size() == kMostOpen) open_.pop_front();
        open_.push_back({key, {}, 0});
        found = std::prev(open_.end());
    }
    found->parts[offset].assign(bytes, bytes + count);
    found->held += count;
    if (found->held > kMostHeld) {  // parts that overlap for ever make no datagram
        open_.erase(found);
        return {};
    }
    if (last) found->size = offset + count;
    if (!complete(*found)) return {};
    std::vector<std::uint8_t> whole(found->size);
    for (const auto& [at, part] : found->parts) {
        if (at >= whole.size()) break;
        const std::size_t used = std::min(part.size(), whole.size() - at);
        std::copy_n(part.begin(), used, whole.begin() + static_cast<std::ptrdiff_t>(at));
    }
    open_.erase(found);
    return whole;
}
}  // namespace delio::io
