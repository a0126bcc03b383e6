#pragma once
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "waiting_queue.h"

namespace delio::io {
/** A UDP datagram as it came. Addresses are IPv4. */
struct LivePacket {
    std::vector<std::uint8_t> payload;
    std::uint32_t from = 0, to = 0;
    std::uint16_t fromPort = 0, toPort = 0;
    timespec time{};  //!< Unix time at which the system received it
};

/** Writes datagrams to a pcap (raw IP, nanoseconds) in a thread of its own: a slow disk delays
 *  nobody. The file is made with the first datagram. A write that fails ends the recording, not the
 *  drive: the file keeps the datagrams before it. */
class PacketRecorder {
 public:
    /** `onWarning`: called by the thread. */
    PacketRecorder(std::string path, std::function<void(const std::string&)> onWarning);
    /** Writes what waits. */
    ~PacketRecorder();
    PacketRecorder(const PacketRecorder&) = delete;
    PacketRecorder& operator=(const PacketRecorder&) = delete;

    void add(std::shared_ptr<const LivePacket> packet);

    /** Datagrams that are not in the file because the disk was too slow. */
    std::size_t missed() const { return missed_; }

 private:
    void run();
    void append(const LivePacket& packet);
    void flush();
    void fail();

    std::string path_;
    std::function<void(const std::string&)> onWarning_;
    std::size_t missed_ = 0;
    int file_ = -1;
    bool failed_ = false;
    std::vector<std::uint8_t> buffer_;  //!< whole records
    std::size_t written_ = 0;           //!< bytes of the file, whole records
    std::time_t flushed_s_ = 0;         //!< time of a datagram
    WaitingQueue<std::shared_ptr<const LivePacket>> waiting_;
    std::thread thread_;
};
}  // namespace delio::io
