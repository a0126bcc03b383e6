#pragma once
#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "delio/recordings/scan_reader.h"
#include "packet_recorder.h"
#include "packet_source.h"
#include "waiting_queue.h"

namespace delio::io {
/** Address and ports that packets are sent to. */
struct UdpAddress {
    std::uint32_t address = 0;  //!< IPv4: of this machine, or a multicast group; 0: any
    std::vector<std::uint16_t> ports;
};

/** Of `udp://[ADDRESS:]PORT[,PORT]...`. Throws Error where it is not that. */
UdpAddress udpAddressIn(const std::string& text);

/** Packets of sockets. A thread receives them, so that the system's small buffers do not run over
 *  while others are busy. */
class LiveSource : public PacketSource {
 public:
    /** Begins to listen. Throws Error where a port is in use or not allowed. */
    LiveSource(const std::string& address, const LiveSettings& settings);
    ~LiveSource() override;

    /** Waits for it; nothing once the drive has ended. */
    std::optional<UdpPacket> next() override;
    bool isLive() const override { return true; }
    void endScan(std::size_t index, double last_s) override;

    /** Unix time of the last packet of a scan that was read lately; of the last scan: of the end of
     *  the drive, which completes it. For the thread that reads. */
    std::optional<double> receivedOf(std::size_t scan) const;

    /** Ends the drive and forgets the packets that wait. */
    void stop();

    /** Received and kept. */
    std::size_t packets() const { return packets_; }
    /** Lost on this machine: the system's buffer, or this one, was full. */
    std::size_t lost() const { return lost_; }
    /** That are missing in the recording; known at the end. */
    std::size_t notRecorded() const { return notRecorded_; }

 private:
    struct Socket {
        int file = -1;
        std::uint16_t port = 0;
        std::uint32_t overrun = 0;  //!< packets that the system has dropped so far
    };
    void listen(std::uint16_t port);
    void closeAll();
    void run();
    bool isOver(double now_s);
    bool receive(Socket& socket);

    std::string name_;
    UdpAddress at_;
    LiveSettings settings_;
    std::vector<Socket> sockets_;
    std::vector<std::uint8_t> buffer_;
    double begin_s_ = 0, latest_s_ = 0;  //!< steady clock: of all, of the latest packet
    bool hasWarned_ = false;
    std::atomic<bool> stopped_{false};
    std::atomic<std::size_t> packets_{0}, lost_{0}, notRecorded_{0};
    std::unique_ptr<PacketRecorder> recorder_;
    WaitingQueue<std::shared_ptr<const LivePacket>> waiting_;
    std::shared_ptr<const LivePacket> current_;
    std::deque<std::pair<std::size_t, double>> ends_;  //!< of the latest scans
    std::optional<double> ended_s_;                    //!< Unix time; none: packets may come
    std::thread thread_;
};
}  // namespace delio::io
