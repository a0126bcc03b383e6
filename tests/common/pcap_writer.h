#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

/** Writes small pcaps. */
namespace delio::test {
using Bytes = std::vector<std::uint8_t>;

template <typename Number>
void putAt(Bytes& bytes, std::size_t at, Number number) {
    std::memcpy(bytes.data() + at, &number, sizeof(number));
}

inline void appendBig(Bytes& bytes, std::uint32_t number, int count) {
    for (int shift = 8 * (count - 1); shift >= 0; shift -= 8)
        bytes.push_back(static_cast<std::uint8_t>(number >> shift));
}

struct PcapWriter {
    std::uint32_t linkType = 1;  //!< Ethernet
    Bytes link = ethernet();     //!< in front of every IP header
    std::uint32_t from = 0xC0A801C9;
    std::uint16_t port = 2368;
    std::size_t mtu = 1500;
    bool backwards = false;  //!< the fragments, last one first

    static Bytes ethernet() {
        Bytes header(12);
        appendBig(header, 0x0800, 2);
        return header;
    }

    void add(const Bytes& payload, double time_s) {
        Bytes udp;
        appendBig(udp, 4321, 2);
        appendBig(udp, port, 2);
        appendBig(udp, static_cast<std::uint32_t>(payload.size() + 8), 2);
        appendBig(udp, 0, 2);
        udp.insert(udp.end(), payload.begin(), payload.end());
        const std::size_t most = (mtu - 20) / 8 * 8;
        std::vector<Bytes> frames;
        for (std::size_t at = 0; at < udp.size(); at += most)
            frames.push_back(frame(udp, at, std::min(most, udp.size() - at)));
        if (backwards) std::reverse(frames.begin(), frames.end());
        for (const Bytes& part : frames) append(part, time_s);
        ++id;
    }

    void write(const std::string& file, std::size_t bytes = SIZE_MAX) const {
        Bytes all(24);
        putAt<std::uint32_t>(all, 0, 0xA1B2C3D4);
        putAt<std::uint16_t>(all, 4, 2);
        putAt<std::uint16_t>(all, 6, 4);
        putAt<std::uint32_t>(all, 16, 1 << 18);
        putAt<std::uint32_t>(all, 20, linkType);
        all.insert(all.end(), records.begin(), records.end());
        std::ofstream out(file, std::ios::binary);
        out.write(reinterpret_cast<const char*>(all.data()),
                  static_cast<std::streamsize>(std::min(bytes, all.size())));
    }

    Bytes frame(const Bytes& udp, std::size_t at, std::size_t count) const {
        Bytes bytes = link;
        appendBig(bytes, 0x4500, 2);
        appendBig(bytes, static_cast<std::uint32_t>(20 + count), 2);
        appendBig(bytes, id, 2);
        const bool more = at + count < udp.size();
        appendBig(bytes, static_cast<std::uint32_t>(at / 8) | (more ? 0x2000U : 0), 2);
        appendBig(bytes, 0x40110000, 4);
        appendBig(bytes, from, 4);
        appendBig(bytes, 0xFFFFFFFF, 4);
        bytes.insert(bytes.end(), udp.begin() + static_cast<std::ptrdiff_t>(at),
                     udp.begin() + static_cast<std::ptrdiff_t>(at + count));
        return bytes;
    }

    void append(const Bytes& part, double time_s) {
        Bytes header(16);
        const auto whole = static_cast<std::uint32_t>(time_s);
        putAt(header, 0, whole);
        putAt(header, 4, static_cast<std::uint32_t>(1e6 * (time_s - whole)));
        putAt(header, 8, static_cast<std::uint32_t>(part.size()));
        putAt(header, 12, static_cast<std::uint32_t>(part.size()));
        records.insert(records.end(), header.begin(), header.end());
        records.insert(records.end(), part.begin(), part.end());
    }

    std::uint16_t id = 1;
    Bytes records;
};
}  // namespace delio::test
