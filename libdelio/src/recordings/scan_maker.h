#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "delio/odometry/scan.h"
#include "message_source.h"
#include "packet_decoder.h"

namespace delio::io {
/** Makes scans from messages: sensor_msgs/PointCloud2, velodyne_msgs/VelodyneScan, Ouster's
 *  PacketMsg, Livox's CustomMsg, or other lists of packets. */
enum class ScanType { kNone, kCloud, kVelodyne, kOuster, kLivox, kPackets };
/** kNone: a topic's messages hold no scans (Ouster's packets of its IMU are of that kind, too). */
ScanType scanTypeOf(const Topic& topic);

/** Makes scans of one topic's messages. */
class ScanMaker {
 public:
    ScanMaker() = default;
    virtual ~ScanMaker() = default;
    ScanMaker(const ScanMaker&) = delete;
    ScanMaker& operator=(const ScanMaker&) = delete;

    /** Looks at one of the first messages, before add(); several show more than one. False: no
     *  more are needed. Throws as add(). */
    virtual bool look(const Message& /*message*/) { return false; }
    /** `scan`: the index of the scan that is being made. Throws Error, which does not name the
     *  file, for a message that cannot be decoded. */
    virtual void add(const Message& message, std::size_t scan) = 0;
    /** There are no more messages. */
    virtual void finish() = 0;
    /** The next scan, if there is one, stamped in Unix seconds; the index is the caller's. */
    virtual std::optional<Scan> take() = 0;
    /** e.g. "Velodyne VLP-16"; empty: not known. */
    virtual std::string sensor() const = 0;
    /** False where the sensor's beams follow a pattern that does not repeat (Livox): a scan may be
     *  made of several messages then. */
    virtual bool turns() const { return true; }
    /** Ignored or corrected data, one line per kind. */
    virtual std::vector<std::string> findings() const { return {}; }
};

/** A scan a message, stamped as its header says, or with the time at which it was recorded where
 *  that is zero. Messages of another frame_id than `frame` are left out. Without a frame all are
 *  taken, and add() throws Error, which lists topic:frame, where there are two: two sensors. */
std::unique_ptr<ScanMaker> makeCloudMaker(const std::string& topic = "",
                                          const std::string& frame = "");
/** For livox_ros_driver/CustomMsg and livox_ros_driver2/CustomMsg: scans of 0.1 s without rings,
 *  stamped as the header of their first message says. Messages of another lidar_id than the first
 *  one's are left out. */
std::unique_ptr<ScanMaker> makeLivoxMaker();
/** For messages with packets: one scan per revolution, independent of the messages. finish() throws
 * Error if the packets gave no scan. */
std::unique_ptr<ScanMaker> makePacketMaker(ScanType type, std::unique_ptr<PacketDecoder> decoder);
}  // namespace delio::io
