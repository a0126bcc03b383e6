#pragma once
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include "pcap_writer.h"

/** Sends datagrams over loopback, as a sensor does. */
namespace delio::test {
inline sockaddr_in loopback(const std::string& address, std::uint16_t port) {
    sockaddr_in result{};
    result.sin_family = AF_INET;
    result.sin_port = htons(port);
    inet_pton(AF_INET, address.c_str(), &result.sin_addr);
    return result;
}

/** A socket on loopback, closed at the end. */
class UdpEnd {
 public:
    /** `from`: an address of loopback, 127.*.*.*; `port`: 0 for any. */
    explicit UdpEnd(const std::string& from = "127.0.0.1", std::uint16_t port = 0)
        : file_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
        const sockaddr_in own = loopback(from, port);
        isBound_ = bind(file_, reinterpret_cast<const sockaddr*>(&own), sizeof(own)) == 0;
    }
    ~UdpEnd() { close(file_); }
    UdpEnd(const UdpEnd&) = delete;
    UdpEnd& operator=(const UdpEnd&) = delete;

    bool isBound() const { return isBound_; }
    std::uint16_t port() const {
        sockaddr_in own{};
        socklen_t size = sizeof(own);
        getsockname(file_, reinterpret_cast<sockaddr*>(&own), &size);
        return ntohs(own.sin_port);
    }
    void send(const Bytes& payload, std::uint16_t to) const {
        const sockaddr_in other = loopback("127.0.0.1", to);
        sendto(file_, payload.data(), payload.size(), 0, reinterpret_cast<const sockaddr*>(&other),
               sizeof(other));
    }
    /** What came within ten seconds; empty: nothing. */
    std::string receive() const {
        const timeval most{10, 0};
        setsockopt(file_, SOL_SOCKET, SO_RCVTIMEO, &most, sizeof(most));
        std::string bytes(65535, '\0');
        const ssize_t count = recv(file_, bytes.data(), bytes.size(), 0);
        bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
        return bytes;
    }

 private:
    int file_;
    bool isBound_ = false;
};

/** A port that nothing listened at just now. */
inline std::uint16_t freePort() { return UdpEnd().port(); }

/** Until something listens at a port of 127.0.0.1; false after a minute. */
inline bool waitForListener(std::uint16_t port) {
    char entry[32];
    std::snprintf(entry, sizeof(entry), " 0100007F:%04X ", port);
    for (int i = 0; i < 6000; ++i) {
        std::ifstream sockets("/proc/net/udp");
        const std::string text{std::istreambuf_iterator<char>(sockets), {}};
        if (text.find(entry) != std::string::npos) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
}
}  // namespace delio::test
