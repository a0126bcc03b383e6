#include "packet_recorder.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace delio::io {
namespace {
constexpr std::size_t kMostWaiting = 64 << 20;  // bytes
constexpr std::size_t kIpHeader = 20, kUdpHeader = 8;

/** Numbers of a pcap's headers, in this machine's byte order. */
template <typename Number>
void append(std::vector<std::uint8_t>& bytes, Number number) {
    const auto* const from = reinterpret_cast<const std::uint8_t*>(&number);
    bytes.insert(bytes.end(), from, from + sizeof(number));
}

/** Numbers of packets. */
void appendBig(std::vector<std::uint8_t>& bytes, std::uint32_t number, int count) {
    for (int shift = 8 * (count - 1); shift >= 0; shift -= 8)
        bytes.push_back(static_cast<std::uint8_t>(number >> shift));
}

std::vector<std::uint8_t> fileHeader() {
    constexpr std::uint32_t kNanoseconds = 0xA1B23C4D, kLongest = 1 << 18, kRawIp = 101;
    std::vector<std::uint8_t> bytes;
    append(bytes, kNanoseconds);
    append(bytes, std::uint16_t{2});
    append(bytes, std::uint16_t{4});
    append(bytes, std::uint64_t{0});
    append(bytes, kLongest);
    append(bytes, kRawIp);
    return bytes;
}

std::uint32_t checksumOf(const std::uint8_t* header) {
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < kIpHeader; i += 2)
        sum += static_cast<std::uint32_t>(header[i] << 8 | header[i + 1]);
    while (sum >> 16U != 0) sum = (sum & 0xFFFFU) + (sum >> 16U);
    return ~sum & 0xFFFFU;
}
}  // namespace

PacketRecorder::PacketRecorder(std::string path, std::function<void(const std::string&)> onWarning)
    : path_(std::move(path)),
      onWarning_(std::move(onWarning)),
      waiting_(kMostWaiting),
      thread_([this] { run(); }) {}

PacketRecorder::~PacketRecorder() {
    waiting_.close();
    thread_.join();
}

void PacketRecorder::add(std::shared_ptr<const LivePacket> packet) {
    const std::size_t bytes = packet->payload.size() + sizeof(LivePacket);
    if (!waiting_.add(std::move(packet), bytes)) ++missed_;
}

void PacketRecorder::run() {
    constexpr std::size_t kMostBuffered = 1 << 18;
    while (const auto packet = waiting_.take()) {
        if (failed_) continue;
        if (file_ < 0) {
            file_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
            if (file_ < 0) {
                fail();
                continue;
            }
            buffer_ = fileHeader();
        }
        append(**packet);
        if (buffer_.size() < kMostBuffered && (*packet)->time.tv_sec == flushed_s_) continue;
        flushed_s_ = (*packet)->time.tv_sec;
        flush();
    }
    if (!failed_) flush();
    if (file_ >= 0) close(file_);
}

void PacketRecorder::append(const LivePacket& packet) {
    const auto bytes = static_cast<std::uint32_t>(packet.payload.size());
    const auto udp = static_cast<std::uint32_t>(kUdpHeader) + bytes;
    const auto all = static_cast<std::uint32_t>(kIpHeader) + udp;
    io::append(buffer_, static_cast<std::uint32_t>(packet.time.tv_sec));
    io::append(buffer_, static_cast<std::uint32_t>(packet.time.tv_nsec));
    io::append(buffer_, all);
    io::append(buffer_, all);
    const std::size_t header = buffer_.size();
    appendBig(buffer_, 0x4500, 2);  // version, length
    appendBig(buffer_, all, 2);
    appendBig(buffer_, 0, 4);           // not a fragment
    appendBig(buffer_, 0x40110000, 4);  // 64 hops, UDP, checksum
    appendBig(buffer_, packet.from, 4);
    appendBig(buffer_, packet.to, 4);
    const std::uint32_t checksum = checksumOf(&buffer_[header]);
    buffer_[header + 10] = static_cast<std::uint8_t>(checksum >> 8U);
    buffer_[header + 11] = static_cast<std::uint8_t>(checksum);
    appendBig(buffer_, packet.fromPort, 2);
    appendBig(buffer_, packet.toPort, 2);
    appendBig(buffer_, udp, 2);
    appendBig(buffer_, 0, 2);  // no checksum
    buffer_.insert(buffer_.end(), packet.payload.begin(), packet.payload.end());
}

void PacketRecorder::flush() {
    for (std::size_t done = 0; done < buffer_.size();) {
        const ssize_t count = write(file_, buffer_.data() + done, buffer_.size() - done);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return fail();
        done += static_cast<std::size_t>(count);
    }
    written_ += buffer_.size();
    buffer_.clear();
}

void PacketRecorder::fail() {
    const std::string why = std::strerror(errno);
    failed_ = true;
    buffer_.clear();
    // A file without a part of a record can be read.
    const bool isCut = file_ >= 0 && ftruncate(file_, static_cast<off_t>(written_)) == 0;
    onWarning_("packets are not recorded to '" + path_ + "'" + (isCut ? " any longer" : "") + " (" +
               why + "); the drive goes on");
}
}  // namespace delio::io
