#include <array>

#include "recordings/scan_maker.h"
#include "target.h"

using namespace delio;

namespace {
const char* const kJson = R"({"beam_altitude_angles": [1, 0], "beam_azimuth_angles": [0, 0],
    "lidar_mode": "512x10", "udp_profile_lidar": "RNG15_RFL8_NIR8"})";

std::unique_ptr<io::ScanMaker> makerOf(std::size_t kind) {
    if (kind == 0) return io::makeCloudMaker();
    if (kind == 1) return io::makePacketMaker(io::ScanType::kVelodyne, io::velodyneDecoder(""));
    if (kind == 2)
        return io::makePacketMaker(io::ScanType::kOuster, io::ousterDecoder(kJson, "sensor.json"));
    if (kind == 3) return io::makeLivoxMaker();
    return io::makePacketMaker(io::ScanType::kPackets, io::recognisingDecoder(""));
}
}  // namespace

/** A ROS message: a cloud, points of a Livox, or packets, as ROS 1 or as CDR. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const std::array<const char*, 9> kTypes{
        "sensor_msgs/PointCloud2",    "velodyne_msgs/VelodyneScan", "ouster_ros/PacketMsg",
        "livox_ros_driver/CustomMsg", "pandar_msgs/PandarScan",     "nebula_msgs/NebulaPackets",
        "hesai_ros_driver/UdpFrame",  "rslidar_msgs/rslidarScan",   "rslidar_msg/RslidarPacket"};
    fuzz::Input input(data, size);
    const auto kind = input.pick(kTypes.size());
    const auto encoding = input.pick(2) == 0 ? io::Encoding::kRos1 : io::Encoding::kCdr;
    return fuzz::mayRefuse([&] {
        const auto maker = makerOf(kind);
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(input.rest().data());
        maker->add({"/points", kTypes[kind], encoding, 1.7e9, {bytes, input.rest().size()}}, 0);
        maker->finish();
        while (maker->take()) {
        }
    });
}
