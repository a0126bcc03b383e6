#include "scan_maker.h"

#include <algorithm>
#include <map>
#include <vector>

#include "delio/core/error.h"
#include "message_source.h"
#include "packet_messages.h"
#include "point_table.h"
#include "scan_parts.h"

namespace delio::io {
namespace {
/** A PointCloud2 as it is written: `rows` of `columns` points, `rowStep` bytes from one to the
 *  next. */
struct Cloud {
    double stamp_s = 0;
    std::string frame;
    std::size_t rows = 0, columns = 0, rowStep = 0;
    PointLayout layout;
    Bytes data;
};

Cloud readCloud(const Message& message) {
    constexpr std::size_t kLeastField = 13;  // an empty name, offset, kind and count
    constexpr std::size_t kMostFields = 1000;
    WireReader in(message);
    Cloud cloud;
    const auto header = in.header();
    cloud.stamp_s = header.stamp_s;
    cloud.frame = header.frame;
    if (cloud.stamp_s == 0) cloud.stamp_s = message.log_s;
    cloud.rows = in.number<std::uint32_t>();
    cloud.columns = in.number<std::uint32_t>();
    const std::size_t fields = in.length(kLeastField);
    if (fields > kMostFields) throw Error("its points have " + std::to_string(fields) + " fields");
    cloud.layout.fields.resize(fields);
    for (PointField& field : cloud.layout.fields) {
        field.name = in.text();
        field.offset = in.number<std::uint32_t>();
        field.kind = static_cast<NumberKind>(in.number<std::uint8_t>());
        in.number<std::uint32_t>();  // count: the first one is taken
    }
    cloud.layout.bigEndian = in.number<std::uint8_t>() != 0;
    cloud.layout.step = in.number<std::uint32_t>();
    cloud.rowStep = in.number<std::uint32_t>();
    cloud.data = in.byteArray();
    in.number<std::uint8_t>();  // is_dense: whether points are NaN is seen from them
    return cloud;
}

class CloudMaker : public ScanMaker {
 public:
    CloudMaker(std::string topic, std::string frame)
        : topic_(std::move(topic)), frame_(std::move(frame)), isChosen_(!frame_.empty()) {}

    bool look(const Message& message) override {
        Cloud cloud = readCloud(message);
        if (isChosen_ && cloud.frame != frame_) return true;
        const std::size_t count = checkedCount(cloud);
        compact(cloud);
        isLivox_ = isLivox(cloud.layout);
        return table_.look(cloud.layout, cloud.data.data, cloud.data.size, count, cloud.stamp_s);
    }
    void add(const Message& message, std::size_t scan) override {
        Cloud cloud = readCloud(message);
        if (!takes(cloud.frame)) return;
        const std::size_t count = checkedCount(cloud);
        compact(cloud);
        Scan made = table_.scan(cloud.layout, cloud.data.data, cloud.data.size, count, cloud.rows,
                                {cloud.stamp_s, scan});
        made.stamp_s = cloud.stamp_s;
        made.time = mrpt::Clock::fromDouble(cloud.stamp_s);
        if (isLivox_)
            joiner_.add(std::move(made));
        else
            scan_ = std::move(made);
    }
    void finish() override { joiner_.finish(); }
    std::optional<Scan> take() override {
        if (isLivox_) return joiner_.take();
        auto scan = std::move(scan_);
        scan_.reset();
        return scan;
    }
    std::string sensor() const override { return isLivox_ ? "Livox" : ""; }
    bool turns() const override { return !isLivox_; }
    std::vector<std::string> findings() const override { return table_.findings(); }

 private:
    bool takes(const std::string& frame) {
        if (frame_.empty()) frame_ = frame;
        if (frame == frame_) return true;
        if (isChosen_) return false;
        throw Error("the topic has scans of two sensors; choose one with --sensor-label: " +
                    topic_ + ":" + frame_ + ", " + topic_ + ":" + frame);
    }

    static std::size_t checkedCount(const Cloud& cloud) {
        const std::size_t count = cloud.rows * cloud.columns;  // of 32 bits each
        const std::size_t step = cloud.layout.step;
        if (count > 0 && (step == 0 || count > cloud.data.size / step))
            throw Error(std::to_string(cloud.rows) + " x " + std::to_string(cloud.columns) +
                        " points of " + std::to_string(step) +
                        " bytes are claimed, but there are " + std::to_string(cloud.data.size) +
                        " bytes");
        return count;
    }

    /** Removes the padding of rows. An impossible row step is ignored: some drivers leave it 0. */
    void compact(Cloud& cloud) {
        const std::size_t row = cloud.columns * cloud.layout.step;
        if (cloud.rows < 2 || cloud.rowStep <= row) return;
        if (cloud.rowStep > (cloud.data.size - row) / (cloud.rows - 1))
            throw Error("its rows of " + std::to_string(cloud.rowStep) + " bytes exceed its " +
                        std::to_string(cloud.data.size) + " bytes");
        rows_.resize(cloud.rows * row);
        for (std::size_t i = 0; i < cloud.rows; ++i)
            std::copy_n(cloud.data.data + i * cloud.rowStep, row, rows_.data() + i * row);
        cloud.data = {rows_.data(), rows_.size()};
    }

    std::string topic_, frame_;  //!< of the first message, if none was chosen
    bool isChosen_;
    bool isLivox_ = false;
    PatternJoiner joiner_;
    PointTable table_;
    std::vector<std::uint8_t> rows_;
    std::optional<Scan> scan_;
};
}  // namespace

std::unique_ptr<ScanMaker> makeCloudMaker(const std::string& topic, const std::string& frame) {
    return std::make_unique<CloudMaker>(topic, frame);
}

namespace {
constexpr std::size_t kMostPackets = 20'000;  // of a message: all are decoded before one is taken

class PacketMaker : public ScanMaker {
 public:
    PacketMaker(ScanType type, std::unique_ptr<PacketDecoder> decoder)
        : type_(type), decoder_(std::move(decoder)) {}

    void add(const Message& message, std::size_t /*scan*/) override {
        if (type_ == ScanType::kOuster) {
            addPacket(WireReader(message).byteArray(), message.log_s);
            return;
        }
        const auto packets = packetsIn(
            message, type_ == ScanType::kVelodyne ? "velodyne_msgs/VelodyneScan" : message.type);
        if (packets.size() > kMostPackets)
            throw Error("the message has " + std::to_string(packets.size()) +
                        " packets; a revolution has a few hundred");
        for (const StampedPacket& packet : packets) addPacket(packet.bytes, packet.stamp_s);
    }
    void finish() override {
        if (!anyTaken_ && otherBytes_ > 0)
            throw Error("packets of " + std::to_string(otherBytes_) +
                        " bytes do not match the sensor's json; give the json recorded with these "
                        "packets (--sensor-info)");
        decoder_->finish();
    }
    std::optional<Scan> take() override { return decoder_->take(); }
    std::string sensor() const override { return decoder_->sensor(); }
    std::vector<std::string> findings() const override { return decoder_->findings(); }

 private:
    void addPacket(const Bytes& packet, double received_s) {
        if (!decoder_->takes(packet.size)) {
            otherBytes_ = packet.size;
            return;
        }
        anyTaken_ = true;
        decoder_->add(packet.data, packet.size, received_s);
    }

    ScanType type_;
    std::unique_ptr<PacketDecoder> decoder_;
    bool anyTaken_ = false;
    std::size_t otherBytes_ = 0;  //!< of a packet that is of another size
};
}  // namespace

std::unique_ptr<ScanMaker> makePacketMaker(ScanType type, std::unique_ptr<PacketDecoder> decoder) {
    return std::make_unique<PacketMaker>(type, std::move(decoder));
}

ScanType scanTypeOf(const Topic& topic) {
    static const std::map<std::string, ScanType> kTypes = {
        {"sensor_msgs/PointCloud2", ScanType::kCloud},
        {"velodyne_msgs/VelodyneScan", ScanType::kVelodyne},
        {"ouster_msgs/PacketMsg", ScanType::kOuster},
        {"ouster_ros/PacketMsg", ScanType::kOuster},
        {"ouster_sensor_msgs/PacketMsg", ScanType::kOuster},
        {"livox_ros_driver/CustomMsg", ScanType::kLivox},
        {"livox_ros_driver2/CustomMsg", ScanType::kLivox},
        {"livox_interfaces/CustomMsg", ScanType::kLivox}};
    const std::string type = plainType(topic.type);
    const auto known = kTypes.find(type);
    if (known == kTypes.end()) return holdsPackets(type) ? ScanType::kPackets : ScanType::kNone;
    const bool imu = topic.name.find("imu", topic.name.rfind('/') + 1) != std::string::npos;
    return known->second == ScanType::kOuster && imu ? ScanType::kNone : known->second;
}
}  // namespace delio::io
