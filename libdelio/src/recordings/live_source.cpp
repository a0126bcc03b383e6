#include "live_source.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <utility>

#include "delio/core/error.h"
#include "delio/core/text.h"

namespace delio::io {
namespace {
constexpr std::string_view kScheme = "udp://";
constexpr std::size_t kLargest = 65535;         // bytes of a datagram
constexpr std::size_t kMostWaiting = 64 << 20;  // bytes

double steady_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

bool isMulticast(std::uint32_t address) { return address >> 28U == 0xE; }

sockaddr_in addressOf(std::uint32_t address, std::uint16_t port) {
    sockaddr_in result{};
    result.sin_family = AF_INET;
    result.sin_addr.s_addr = htonl(address);
    result.sin_port = htons(port);
    return result;
}
}  // namespace

bool isLive(const std::string& path) { return path.rfind(kScheme, 0) == 0; }

UdpAddress udpAddressIn(const std::string& text) {
    const Error wrong("'" + text +
                      "' is not udp://[ADDRESS:]PORT[,PORT]... with an IPv4 address of this "
                      "machine or of a multicast group");
    if (!isLive(text)) throw wrong;
    std::string rest = text.substr(kScheme.size());
    UdpAddress result;
    if (const auto colon = rest.rfind(':'); colon != rest.npos) {
        in_addr address{};
        if (colon > 0 && inet_pton(AF_INET, rest.substr(0, colon).c_str(), &address) != 1)
            throw wrong;
        result.address = ntohl(address.s_addr);
        rest.erase(0, colon + 1);
    }
    for (std::size_t at = 0; at <= rest.size();) {
        const std::size_t end = std::min(rest.find(',', at), rest.size());
        const auto port = numberIn<std::uint16_t>(std::string_view(rest).substr(at, end - at));
        if (!port || *port == 0) throw wrong;
        result.ports.push_back(*port);
        at = end + 1;
    }
    return result;
}

LiveSource::LiveSource(const std::string& address, const LiveSettings& settings)
    : name_(address),
      at_(udpAddressIn(address)),
      settings_(settings),
      buffer_(kLargest),
      begin_s_(steady_s()),
      waiting_(kMostWaiting) {
    if (!settings_.onWarning) settings_.onWarning = [](const std::string&) {};
    try {
        for (const std::uint16_t port : at_.ports) listen(port);
    } catch (const Error&) {
        closeAll();
        throw;
    }
    // Signals go to the other threads.
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    if (!settings_.record.empty())
        recorder_ = std::make_unique<PacketRecorder>(settings_.record, settings_.onWarning);
    thread_ = std::thread([this] { run(); });
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

LiveSource::~LiveSource() {
    stop();
    thread_.join();
    closeAll();
}

void LiveSource::closeAll() {
    for (const Socket& socket : sockets_) close(socket.file);
}

void LiveSource::listen(std::uint16_t port) {
    const auto fail = [&] {
        const std::string why = std::strerror(errno);
        throw Error("cannot listen to port " + std::to_string(port) + " of '" + name_ +
                    "': " + why);
    };
    const int file = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (file < 0) fail();
    sockets_.push_back({file, port});
    const int on = 1, room = 8 << 20;
    setsockopt(file, SOL_SOCKET, SO_RCVBUF, &room, sizeof(room));  // less is no fault
    setsockopt(file, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof(on));
    setsockopt(file, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof(on));
    if (isMulticast(at_.address)) {
        setsockopt(file, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
        ip_mreq group{};
        group.imr_multiaddr.s_addr = htonl(at_.address);
        if (setsockopt(file, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof(group)) != 0) fail();
    }
    const sockaddr_in own = addressOf(at_.address, port);
    if (bind(file, reinterpret_cast<const sockaddr*>(&own), sizeof(own)) != 0) fail();
}

bool LiveSource::isOver(double now_s) {
    constexpr double kPatience_s = 3;
    if (stopped_ || (settings_.isEnded && settings_.isEnded())) return true;
    if (packets_ > 0) return settings_.idle_s > 0 && now_s - latest_s_ > settings_.idle_s;
    if (now_s - begin_s_ > kPatience_s && !std::exchange(hasWarned_, true))
        settings_.onWarning("no packet has come to '" + name_ +
                            "' yet; check the destination address and port that are set in the "
                            "sensor, and the firewall");
    return false;
}

void LiveSource::run() {
    constexpr int kWait_ms = 50;
    std::vector<pollfd> waiting;
    for (const Socket& socket : sockets_) waiting.push_back({socket.file, POLLIN, 0});
    while (!isOver(steady_s())) {
        poll(waiting.data(), waiting.size(), kWait_ms);
        // One of each in turn: as they came, more or less, where there are several ports.
        for (bool any = true; any && !stopped_;) {
            any = false;
            for (Socket& socket : sockets_) any = receive(socket) || any;
            if (settings_.isEnded && settings_.isEnded()) break;
        }
    }
    if (recorder_) notRecorded_ = recorder_->missed();
    recorder_.reset();  // writes what waits
    waiting_.close();
}

bool LiveSource::receive(Socket& socket) {
    sockaddr_in from{};
    iovec part{buffer_.data(), buffer_.size()};
    alignas(cmsghdr) char control[256];
    msghdr message{};
    message.msg_name = &from;
    message.msg_namelen = sizeof(from);
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof(control);
    const ssize_t bytes = recvmsg(socket.file, &message, 0);
    if (bytes < 0) return false;
    auto packet = std::make_shared<LivePacket>();
    packet->payload.assign(buffer_.data(), buffer_.data() + bytes);
    packet->from = ntohl(from.sin_addr.s_addr);
    packet->fromPort = ntohs(from.sin_port);
    packet->to = at_.address;
    packet->toPort = socket.port;
    clock_gettime(CLOCK_REALTIME, &packet->time);
    for (auto* item = CMSG_FIRSTHDR(&message); item; item = CMSG_NXTHDR(&message, item)) {
        if (item->cmsg_level != SOL_SOCKET) continue;
        if (item->cmsg_type == SCM_TIMESTAMPNS)
            std::memcpy(&packet->time, CMSG_DATA(item), sizeof(packet->time));
        if (item->cmsg_type != SO_RXQ_OVFL) continue;
        std::uint32_t overrun = 0;
        std::memcpy(&overrun, CMSG_DATA(item), sizeof(overrun));
        lost_ += overrun - std::exchange(socket.overrun, overrun);
    }
    latest_s_ = steady_s();
    const std::size_t weight = packet->payload.size() + sizeof(LivePacket);
    // What is not used is not recorded: the recording gives the same trajectory.
    if (!waiting_.add(packet, weight)) {
        ++lost_;
        return true;
    }
    ++packets_;
    if (recorder_) recorder_->add(std::move(packet));
    return true;
}

std::optional<UdpPacket> LiveSource::next() {
    const auto packet = waiting_.take();
    if (!packet) {
        ended_s_ =
            std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch())
                .count();
        return {};
    }
    current_ = *packet;
    UdpPacket udp;
    udp.payload = current_->payload.data();
    udp.bytes = current_->payload.size();
    udp.from = current_->from;
    udp.fromPort = current_->fromPort;
    udp.toPort = current_->toPort;
    udp.time_s = static_cast<double>(current_->time.tv_sec) +
                 1e-9 * static_cast<double>(current_->time.tv_nsec);
    return udp;
}

void LiveSource::endScan(std::size_t index, double last_s) {
    constexpr std::size_t kMost = 32;  // more than any reader reads ahead
    ends_.emplace_back(index, ended_s_.value_or(last_s));
    if (ends_.size() > kMost) ends_.pop_front();
}

std::optional<double> LiveSource::receivedOf(std::size_t scan) const {
    for (const auto& [index, last_s] : ends_)
        if (index == scan) return last_s;
    return {};
}

void LiveSource::stop() {
    stopped_ = true;
    waiting_.discard();
}
}  // namespace delio::io
