#include "delio/core/error.h"
#include "scan_maker.h"
#include "wire_reader.h"

namespace delio::io {
namespace {
constexpr std::size_t kVelodynePacket = 1206;

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
    void finish() override { decoder_->finish(); }
    std::optional<Scan> take() override { return decoder_->take(); }
    std::string sensor() const override { return decoder_->sensor(); }

 private:
    void addVelodyneScan(WireReader& in, double log_s) {
        in.header();
        const std::size_t packets = in.length(8 + kVelodynePacket);
        for (std::size_t i = 0; i < packets; ++i) {
            const double stamp_s = in.time();
            addPacket(in.bytes(kVelodynePacket), stamp_s == 0 ? log_s : stamp_s);
        }
    }
    void addPacket(const Bytes& packet, double received_s) {
        if (decoder_->takes(packet.size)) decoder_->add(packet.data, packet.size, received_s);
    }

    ScanType type_;
    std::unique_ptr<PacketDecoder> decoder_;
};
}  // namespace

std::unique_ptr<ScanMaker> makePacketMaker(ScanType type, std::unique_ptr<PacketDecoder> decoder) {
    return std::make_unique<PacketMaker>(type, std::move(decoder));
}
}  // namespace delio::io
