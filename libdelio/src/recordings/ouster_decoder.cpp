#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <optional>

#include "delio/core/error.h"
#include "findings.h"
#include "imu_samples.h"
#include "ouster.h"
#include "packet_decoder.h"

namespace delio::io {
namespace {
/** Takes the first return, the strongest. Points come column by column, so in the order of time,
 *  and upper rows first; their intensity is the reflectivity, 255 being 1. Columns that the sensor
 *  calls invalid and pixels without a return are left out, and so are packets of a revolution that
 *  arrive after the next one has begun, and packets of sensors other than the json's. */
class OusterDecoder : public PacketDecoder {
 public:
    OusterDecoder(const std::string& json, const std::string& name)
        : info_(readOusterInfo(json, name)), name_(name), maker_(info_) {}

    bool takes(std::size_t bytes) const override { return bytes == info_.packetBytes(); }
    bool add(const std::uint8_t* payload, std::size_t bytes, double received_s) override;
    void finish() override;
    std::optional<Scan> take() override;
    bool endedWhole() const override { return !frame_; }
    bool addImu(const std::uint8_t* payload, std::size_t bytes) override {
        return addOusterImu(info_, payload, bytes, imu_);
    }
    std::vector<ImuSample> takeImu() override { return maker_.takeImu(imu_); }
    std::string sensor() const override { return info_.sensor(); }
    std::vector<std::string> findings() const override;

 private:
    /** The sensor has another initialization_id since it was started again during the drive. */
    bool isRestarted(const OusterIds& ids) const {
        return packets_ > 0 && ids.serial != 0 && ids.serial == info_.ids.serial;
    }
    bool isLate(std::uint16_t number) const;
    void leaveOut(const OusterIds& ids);
    Error foreign() const;
    void endFrame(bool partial);

    OusterInfo info_;
    std::string name_;
    OusterScans maker_;
    std::optional<OusterFrame> frame_;
    std::optional<std::uint16_t> latestFrame_;  //!< number of that one, or of the one before
    bool first_ = true;                         //!< the recording may begin within this frame
    std::size_t packets_ = 0;                   //!< of this sensor
    OusterIds foreignIds_;                      //!< of the first packet of another sensor
    Happened foreign_;
    std::deque<Scan> scans_;
    std::vector<OusterImu> imu_;  //!< that nobody took yet
};

std::string textOf(const OusterIds& ids) {
    return "serial number " + std::to_string(ids.serial) + " (initialization_id " +
           std::to_string(ids.initialization) + ")";
}

Error OusterDecoder::foreign() const {
    std::string text = "the packets come from the Ouster with " + textOf(foreignIds_) + ", '" +
                       name_ + "' describes the one with " + textOf(info_.ids) +
                       "; give the json recorded with these packets (--sensor-info)";
    if (foreignIds_.serial == info_.ids.serial)
        text += ", or remove initialization_id from it if the sensor was only restarted";
    return Error(text);
}

/** Few packets of another sensor may come first: then it is not known yet that all of them are. */
void OusterDecoder::leaveOut(const OusterIds& ids) {
    constexpr std::size_t kMost = 1000;
    if (foreign_.count == 0) foreignIds_ = ids;
    foreign_.add(1, maker_.made());
    if (packets_ == 0 && foreign_.count >= kMost) throw foreign();
}

std::vector<std::string> OusterDecoder::findings() const {
    std::vector<std::string> findings;
    if (packets_ > 0 && foreign_.count > 0)
        findings.push_back("ignored " + foreign_.of("packet") + " of the Ouster with " +
                           textOf(foreignIds_) + ", which '" + name_ + "' does not describe");
    for (std::string& finding : maker_.findings()) findings.push_back(std::move(finding));
    return findings;
}

/** True for a column of a turn that has ended. Numbers wrap after 65535. A slightly older one is
 *  late; a much older one means a restart. */
bool OusterDecoder::isLate(std::uint16_t number) const {
    constexpr int kLate = 16;
    if (!latestFrame_) return false;
    const auto ahead =
        static_cast<std::int16_t>(static_cast<std::uint16_t>(number - *latestFrame_));
    return ahead <= (frame_ ? -1 : 0) && ahead > -kLate;
}

bool OusterDecoder::add(const std::uint8_t* payload, std::size_t bytes, double received_s) {
    if (!takes(bytes))
        throw Error("an Ouster packet of " + std::to_string(bytes) + " bytes; '" + name_ +
                    "' describes packets of " + std::to_string(info_.packetBytes()));
    const OusterPacket packet(info_, payload);
    if (const OusterIds ids = packet.ids(); !info_.ids.fit(ids) && !isRestarted(ids)) {
        leaveOut(ids);
        return false;
    }
    ++packets_;
    for (std::size_t column = 0; column < info_.columnsPerPacket; ++column) {
        if (!packet.valid(column)) continue;
        if (packet.place(column) >= info_.columns)
            throw Error("an Ouster packet has column " + std::to_string(packet.place(column)) +
                        "; '" + name_ + "' has " + std::to_string(info_.columns));
        const std::uint16_t number = packet.frameOf(column);
        if (isLate(number)) continue;
        if (frame_ && number != frame_->number) {
            endFrame(first_);
            first_ = false;
        }
        if (!frame_) {
            latestFrame_ = number;
            frame_.emplace(info_);
            frame_->number = number;
            frame_->received_s = received_s;
        }
        packet.copyTo(*frame_, column);
        maker_.prepare(*frame_, packet.place(column));
        if (frame_->count < info_.columns) continue;
        endFrame(false);
        first_ = false;
    }
    return true;
}

void OusterDecoder::finish() {
    endFrame(true);
    if (packets_ == 0 && foreign_.count > 0) throw foreign();
    if (packets_ == 0 || maker_.made() > 0) return;
    const std::size_t turn =
        (info_.columnsUsed + info_.columnsPerPacket - 1) / info_.columnsPerPacket;
    if (packets_ < turn)
        throw Error("only " + std::to_string(packets_) + " of the " + std::to_string(turn) +
                    " packets of a revolution; a scan needs at least half a revolution");
    throw Error("no scan in " + std::to_string(packets_) +
                " Ouster packets: their columns are marked as invalid");
}

void OusterDecoder::endFrame(bool partial) {
    if (frame_ && (!partial || 2 * frame_->count >= info_.columnsUsed))
        scans_.push_back(maker_.scanOf(*frame_));
    frame_.reset();
}

std::optional<Scan> OusterDecoder::take() {
    if (scans_.empty()) return {};
    Scan scan = std::move(scans_.front());
    scans_.pop_front();
    return scan;
}
}  // namespace

std::unique_ptr<PacketDecoder> ousterDecoder(const std::string& json, const std::string& name) {
    return std::make_unique<OusterDecoder>(json, name);
}

namespace {
template <typename Number>
Number numberAt(const std::uint8_t* bytes) {
    Number number;
    std::memcpy(&number, bytes, sizeof(number));
    return number;
}

Eigen::Vector3d vectorAt(const std::uint8_t* bytes) {
    return Eigen::Vector3f(numberAt<float>(bytes), numberAt<float>(bytes + 4),
                           numberAt<float>(bytes + 8))
        .cast<double>();
}
}  // namespace

bool addOusterImu(const OusterInfo& info, const std::uint8_t* payload, std::size_t bytes,
                  std::vector<OusterImu>& samples) {
    // One sample: times of the system, the accelerometer and the gyroscope; g; deg/s.
    constexpr std::size_t kOne = 48, kGyroscopeTime = 16, kAcceleration = 24, kRate = 36;
    constexpr double kG_mps2 = 9.80665;
    if (bytes == kOne) {
        addSample(OusterImu{numberAt<std::uint64_t>(payload + kGyroscopeTime),
                            kG_mps2 * vectorAt(payload + kAcceleration),
                            M_PI / 180 * vectorAt(payload + kRate)},
                  samples);
        return true;
    }
    // Several: header, a sentence of a GNSS receiver; time, number, status, m/s^2, rad/s of each.
    constexpr std::size_t kHead = 132, kSample = 36, kTail = 32, kStatus = 10, kInside = 12;
    if (info.imuSamples == 0 || bytes != kHead + info.imuSamples * kSample + kTail) return false;
    for (std::size_t i = 0; i < info.imuSamples; ++i) {
        const std::uint8_t* const at = payload + kHead + i * kSample;
        if ((at[kStatus] & 1U) == 0) continue;  // it was not measured
        addSample(OusterImu{numberAt<std::uint64_t>(at), vectorAt(at + kInside),
                            vectorAt(at + 2 * kInside)},
                  samples);
    }
    return true;
}

OusterIds OusterPacket::ids() const {
    if (info_.layout.legacy) return {};
    constexpr std::uint64_t k24Bits = 0xFFFFFF, k40Bits = 0xFFFFFFFFFF;
    const bool safety = info_.layout.safety;
    return {
        numberAt<std::uint64_t>(bytes_ + (safety ? 11 : 7)) & k40Bits,
        static_cast<std::uint32_t>(numberAt<std::uint64_t>(bytes_ + (safety ? 1 : 4)) & k24Bits)};
}

std::uint64_t OusterPacket::time_ns(std::size_t column) const {
    return numberAt<std::uint64_t>(at(column));
}

std::size_t OusterPacket::place(std::size_t column) const {
    return numberAt<std::uint16_t>(at(column) + 8);
}

std::uint16_t OusterPacket::frameOf(std::size_t column) const {
    if (info_.layout.legacy) return numberAt<std::uint16_t>(at(column) + 10);
    return numberAt<std::uint16_t>(bytes_ + (info_.layout.safety ? 4 : 2));
}

bool OusterPacket::valid(std::size_t column) const {
    const OusterLayout& layout = info_.layout;
    if (layout.legacy)
        return numberAt<std::uint32_t>(at(column) + info_.columnBytes() - layout.columnFooter) ==
               0xFFFFFFFF;
    return numberAt<std::uint16_t>(at(column) + 10) & 1U;
}

void OusterPacket::copyTo(OusterFrame& frame, std::size_t column) const {
    const OusterLayout& layout = info_.layout;
    const std::size_t to = place(column);
    if (!frame.received[to]) ++frame.count;
    frame.received[to] = true;
    frame.times_ns[to] = time_ns(column);
    const std::uint8_t* pixel = at(column) + layout.columnHeader;
    for (std::size_t i = to * info_.rows; i < (to + 1) * info_.rows; ++i, pixel += layout.pixel) {
        const std::uint32_t range = layout.rangeBytes == 2 ? numberAt<std::uint16_t>(pixel)
                                                           : numberAt<std::uint32_t>(pixel);
        frame.ranges_mm[i] = (range & layout.rangeMask) * layout.rangeUnit_mm;
        const std::uint8_t* const reflectivity = pixel + layout.reflectivityAt;
        frame.reflectivities[i] = layout.reflectivityBytes == 1
                                      ? *reflectivity
                                      : static_cast<std::uint8_t>(std::min<std::uint16_t>(
                                            255, numberAt<std::uint16_t>(reflectivity)));
    }
}
}  // namespace delio::io
