#include "delio/core/error.h"
#include "scan_maker.h"
#include "wire_reader.h"

namespace delio::io {
namespace {
constexpr std::size_t kVelodynePacket = 1206;
constexpr std::size_t kMostPackets = 20'000;  // of a message: all are decoded before one is taken

class PacketMaker : public ScanMaker {
 public:
    PacketMaker(ScanType type, std::unique_ptr<PacketDecoder> decoder)
        : type_(type), decoder_(std::move(decoder)) {}

    void add(const Message& message, std::size_t /*scan*/) override {
        WireReader in(message);
        if (type_ == ScanType::kOuster)
            addPacket(in.byteArray(), message.log_s);
        else
            addVelodyneScan(in, message.log_s);
    }
    void finish() override {
        if (!anyTaken_ && otherBytes_ > 0)
            throw Error("packets of " + std::to_string(otherBytes_) +
                        " bytes, which the sensor's json does not describe; give the json that "
                        "was recorded with them (--sensor-info)");
        decoder_->finish();
    }
    std::optional<Scan> take() override { return decoder_->take(); }
    std::string sensor() const override { return decoder_->sensor(); }
    std::vector<std::string> findings() const override { return decoder_->findings(); }

 private:
    void addVelodyneScan(WireReader& in, double log_s) {
        in.header();
        const std::size_t packets = in.length(8 + kVelodynePacket);
        if (packets > kMostPackets)
            throw Error("the message has " + std::to_string(packets) +
                        " packets: a turn has some hundred");
        for (std::size_t i = 0; i < packets; ++i) {
            const double stamp_s = in.time();
            addPacket(in.bytes(kVelodynePacket), stamp_s == 0 ? log_s : stamp_s);
        }
    }
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
}  // namespace delio::io
