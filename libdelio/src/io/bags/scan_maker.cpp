#include "scan_maker.h"

#include <map>

#include "delio/core/error.h"

namespace delio::io {
ScanType scanTypeOf(const Topic& topic) {
    static const std::map<std::string, ScanType> kTypes = {
        {"sensor_msgs/PointCloud2", ScanType::kCloud},
        {"velodyne_msgs/VelodyneScan", ScanType::kVelodyne},
        {"ouster_msgs/PacketMsg", ScanType::kOuster},
        {"ouster_ros/PacketMsg", ScanType::kOuster},
        {"ouster_sensor_msgs/PacketMsg", ScanType::kOuster}};
    std::string type = topic.type;
    const std::string part = "/msg/";  // as ROS 2 has it
    if (const auto at = type.find(part); at != std::string::npos)
        type.replace(at, part.size(), "/");
    const auto known = kTypes.find(type);
    if (known == kTypes.end()) return ScanType::kNone;
    const bool imu = topic.name.find("imu", topic.name.rfind('/') + 1) != std::string::npos;
    return known->second == ScanType::kOuster && imu ? ScanType::kNone : known->second;
}
}  // namespace delio::io
