#pragma once
#include <string>
#include <vector>

#include "message_source.h"

namespace delio::io {
/** A packet of a message, and when it was received. */
struct StampedPacket {
    Bytes bytes;
    double stamp_s = 0;  //!< Unix
};

/** A message's type without ROS 2's "/msg/". */
std::string plainType(const std::string& type);

/** True for messages with packets of spinning LiDARs other than Ouster's:
 * velodyne_msgs/VelodyneScan, pandar_msgs/PandarScan, nebula_msgs/NebulaPackets,
 * hesai_ros_driver/UdpFrame, robosense_msgs/RobosenseScan, rslidar_msgs/rslidarScan,
 * rslidar_msg/RslidarPacket. `type`: as plainType() has it. */
bool holdsPackets(const std::string& type);

/** True for messages with the description of a RoboSense (DIFOP), which lie in a topic of their
 * own: robosense_msgs/RobosenseInfoPacket, rslidar_msgs/rslidarPacket. `type`: as above. */
bool holdsDescription(const std::string& type);

StampedPacket descriptionIn(const Message& message, const std::string& type);

/** The packets of a message of a type that holdsPackets(), which live as long as it. Where they
 * have no stamp, they have the time at which the message was recorded. Throws Error where it is cut
 * off. */
std::vector<StampedPacket> packetsIn(const Message& message, const std::string& type);
}  // namespace delio::io
