#include <utility>

#include "delio/core/error.h"
#include "forwarding_decoder.h"
#include "hesai.h"
#include "packet_decoder.h"
#include "robosense.h"

namespace delio::io {
std::string makerOf(const std::uint8_t* packet, std::size_t bytes) {
    constexpr std::size_t kVelodyne = 1206;
    if (bytes == kVelodyne) return "velodyne";
    if (isRobosensePacket(packet, bytes)) return "robosense";
    if (!isHesaiSize(bytes)) return "";
    const bool isMarked =
        (packet[0] == 0xEE && packet[1] == 0xFF) || (packet[0] == 0xFF && packet[1] == 0xEE);
    return isMarked ? "hesai" : "";
}

std::unique_ptr<PacketDecoder> decoderFor(const std::string& maker, const std::string& sensorFile) {
    if (maker == "hesai") return hesaiDecoder(sensorFile);
    if (maker == "robosense") return robosenseDecoder(sensorFile);
    return velodyneDecoder(sensorFile);
}

namespace {
class RecognisingDecoder : public ForwardingDecoder {
 public:
    explicit RecognisingDecoder(std::string sensorFile) : sensorFile_(std::move(sensorFile)) {}

    bool takes(std::size_t /*bytes*/) const override { return true; }
    bool add(const std::uint8_t* payload, std::size_t bytes, double received_s) override {
        const std::string maker = makerOf(payload, bytes);
        if (maker.empty()) {
            other_ = bytes;
            return false;
        }
        if (!decoder_) {
            decoder_ = decoderFor(maker, sensorFile_);
            maker_ = maker;
        }
        return maker == maker_ && decoder_->add(payload, bytes, received_s);
    }
    void finish() override {
        if (!decoder_ && other_ > 0)
            throw Error("packets of " + std::to_string(other_) +
                        " bytes are of no LiDAR that is supported; inputs.md in DeLiO's "
                        "documentation lists these");
        ForwardingDecoder::finish();
    }

 private:
    std::string sensorFile_, maker_;
    std::size_t other_ = 0;  //!< bytes of a packet of no known maker
};
}  // namespace

std::unique_ptr<PacketDecoder> recognisingDecoder(const std::string& sensorFile) {
    return std::make_unique<RecognisingDecoder>(sensorFile);
}
}  // namespace delio::io
