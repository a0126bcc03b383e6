#include "packet_messages.h"

#include <algorithm>
#include <map>

#include "delio/core/error.h"
#include "packet_decoder.h"

namespace delio::io {
namespace {
/** How a message lists packets. */
struct PacketList {
    bool isOne = false;     //!< the message is a packet
    bool hasHeader = true;  //!< of the message
    bool hasStamp = true;   //!< of each packet
    std::size_t room = 0;   //!< bytes of each packet, filled or not; 0: it has its own length
    bool hasSize = false;   //!< of each packet, behind its bytes: how many of them count
    std::size_t flags = 0;  //!< bytes in front of a packet's length
};

PacketList listOf(std::size_t room) {
    PacketList list;
    list.room = room;
    return list;
}

PacketList listWithSizes(std::size_t room) {
    PacketList list = listOf(room);
    list.hasSize = true;
    return list;
}

/** Messages of Hesai's driver changed from version to version. */
std::vector<PacketList> udpFrames() {
    std::vector<PacketList> ways(3, listWithSizes(0));
    ways[0].hasStamp = ways[1].hasStamp = ways[1].hasHeader = false;
    return ways;
}

PacketList onePacket() {
    PacketList list;
    list.isOne = true;
    list.hasStamp = false;
    list.flags = 2;
    return list;
}

constexpr std::size_t kVelodyne = 1206, kPandar = 1500, kRobosense = 1248;

const std::map<std::string, std::vector<PacketList>>& lists() {
    static const std::map<std::string, std::vector<PacketList>> kLists{
        {"velodyne_msgs/VelodyneScan", {listOf(kVelodyne)}},
        {"pandar_msgs/PandarScan", {listWithSizes(kPandar)}},
        {"hesai_lidar/PandarScan", {listWithSizes(kPandar)}},
        {"nebula_msgs/NebulaPackets", {listOf(0)}},
        {"hesai_ros_driver/UdpFrame", udpFrames()},
        {"robosense_msgs/RobosenseScan", {listOf(kRobosense)}},
        {"rslidar_msgs/rslidarScan", {listOf(kRobosense)}},
        {"rslidar_msg/RslidarPacket", {onePacket()}}};
    return kLists;
}

Bytes packetIn(WireReader& in, const PacketList& list) {
    in.bytes(list.flags);
    Bytes packet = list.room > 0 ? in.bytes(list.room) : in.byteArray();
    if (!list.hasSize) return packet;
    const std::size_t size = in.number<std::uint32_t>();
    if (size > packet.size)
        throw Error("a packet of " + std::to_string(size) + " bytes is claimed, but there are " +
                    std::to_string(packet.size));
    packet.size = size;
    return packet;
}

bool isOfALidar(const Bytes& packet) { return !makerOf(packet.data, packet.size).empty(); }

std::vector<StampedPacket> packetsIn(const Message& message, const PacketList& list) {
    WireReader in(message);
    const double stamp_s = list.hasHeader ? in.header().stamp_s : 0;
    // All that a packet has at least.
    const std::size_t least = (list.hasStamp ? 8 : 0) + std::max<std::size_t>(list.room, 4);
    const std::size_t count = list.isOne ? 1 : in.length(least);
    std::vector<StampedPacket> packets;
    for (std::size_t i = 0; i < count; ++i) {
        StampedPacket packet;
        packet.stamp_s = list.hasStamp ? in.time() : list.isOne ? stamp_s : 0;
        packet.bytes = packetIn(in, list);
        if (packet.stamp_s == 0) packet.stamp_s = message.log_s;
        packets.push_back(packet);
    }
    return packets;
}
}  // namespace

std::string plainType(const std::string& type) {
    const std::string part = "/msg/";
    const auto at = type.find(part);
    return at == std::string::npos ? type : std::string(type).replace(at, part.size(), "/");
}

bool holdsPackets(const std::string& type) { return lists().count(type) > 0; }

bool holdsDescription(const std::string& type) {
    return type == "robosense_msgs/RobosenseInfoPacket" || type == "rslidar_msgs/rslidarPacket";
}

StampedPacket descriptionIn(const Message& message, const std::string& type) {
    WireReader in(message);
    if (type == "robosense_msgs/RobosenseInfoPacket") in.text();  // the model
    StampedPacket packet;
    packet.stamp_s = in.time();
    packet.bytes = in.bytes(kRobosense);
    return packet;
}

std::vector<StampedPacket> packetsIn(const Message& message, const std::string& type) {
    const auto found = lists().find(plainType(type));
    if (found == lists().end()) throw Error("messages of type " + type + " have no packets");
    const auto& ways = found->second;
    if (ways.size() == 1) return packetsIn(message, ways.front());
    for (const PacketList& list : ways) {
        try {
            auto packets = packetsIn(message, list);
            if (!packets.empty() && isOfALidar(packets.front().bytes)) return packets;
        } catch (const Error&) {
        }
    }
    throw Error("the message is cut off or has another type");
}
}  // namespace delio::io
