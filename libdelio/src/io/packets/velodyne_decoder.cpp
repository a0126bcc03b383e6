#include <cmath>
#include <cstddef>
#include <cstring>
#include <deque>
#include <vector>

#include "../drive_clock.h"
#include "../velodyne_packets.h"
#include "delio/core/error.h"
#include "happened.h"
#include "packet_decoder.h"
#include "turn_times.h"
#include "velodyne_clock.h"
#include "velodyne_models.h"

namespace delio::io {
namespace {
using Packet = mrpt::obs::CObservationVelodyneScan::TVelodyneRawPacket;
constexpr std::size_t kBlocks = 12, kBlockBytes = 100;
constexpr int kTurn = 36000;  // of azimuths, 0.01 deg
/** More packets than any turn has: a sensor that stands still must not fill the memory. */
constexpr std::size_t kMostPackets = 4000;

/** Turns begin where the azimuth passes 0, between two blocks. Its packet is part of both turns,
 *  each time with the blocks of the other one blanked. */
class VelodyneDecoder : public PacketDecoder {
 public:
    explicit VelodyneDecoder(std::string calibrationFile)
        : calibrationFile_(std::move(calibrationFile)) {}

    bool takes(std::size_t bytes) const override { return bytes == sizeof(Packet); }
    bool add(const std::uint8_t* payload, std::size_t bytes, double received_s) override;
    void finish() override;
    std::optional<Scan> take() override;
    std::string sensor() const override {
        return model_.name.empty() ? "" : "Velodyne " + model_.name;
    }
    std::vector<std::string> findings() const override;

 private:
    /** Blocks `from` to before `to` of a packet are of this turn; the first one `turned` 0.01 deg
     *  after its begin. */
    void keep(const std::uint8_t* payload, std::size_t from, std::size_t to, double time_s,
              int turned);
    void endTurn(bool partial);
    /** Of each packet, from its first one on. */
    std::vector<double> startsOfPackets();

    std::string calibrationFile_;
    VelodyneModel model_;
    VelodyneClock clock_;
    std::vector<Packet> packets_;
    std::vector<double> times_s_;       //!< Unix time of each packet
    std::vector<double> places_;        //!< of each packet: part of a turn since the turn began
    int azimuth_ = -1;                  //!< of the last block
    int turned_ = 0;                    //!< since the turn began
    int turnedInAll_ = 0;               //!< in the turns before the first scan
    bool first_ = true;                 //!< the recording may begin within this turn
    std::size_t taken_ = 0, made_ = 0;  //!< packets, scans
    Happened mended_, untimed_;
    std::deque<Scan> scans_;
};

bool VelodyneDecoder::add(const std::uint8_t* payload, std::size_t bytes, double received_s) {
    if (!takes(bytes)) throw Error("a Velodyne's packet of " + std::to_string(bytes) + " bytes");
    const std::string name = velodyneModelName(payload);
    if (model_.name.empty()) model_ = velodyneModel(name, calibrationFile_);
    if (model_.name != name)
        throw Error("a packet of a Velodyne " + name + " among those of a " + model_.name);
    std::uint32_t clock_us = 0;
    std::memcpy(&clock_us, payload + kBlocks * kBlockBytes, sizeof(clock_us));
    const double time_s = clock_.timeOf(clock_us, received_s);
    ++taken_;
    std::size_t from = 0;
    int turned = turned_;
    for (std::size_t b = 0; b < kBlocks; ++b) {
        const std::uint8_t* const block = payload + kBlockBytes * b;
        const int azimuth = block[2] | block[3] << 8;
        if (azimuth >= kTurn) continue;
        if (azimuth_ >= 0 && azimuth < azimuth_ - kTurn / 2) {
            keep(payload, from, b, time_s, turned);
            endTurn(first_);
            first_ = false;
            from = b;
        } else if (azimuth_ >= 0) {
            turned_ += std::max(0, azimuth - azimuth_);
        }
        azimuth_ = azimuth;
        if (b == from) turned = turned_;
    }
    keep(payload, from, kBlocks, time_s, turned);
    if (packets_.size() >= kMostPackets) endTurn(false);
    return true;
}

void VelodyneDecoder::finish() {
    endTurn(true);
    if (taken_ == 0 || made_ > 0) return;
    throw Error("only " + std::to_string(turnedInAll_ / 100) + " of 360 degrees in " +
                std::to_string(taken_) + " packets of a " + sensor() +
                ": there is no scan in less than half a turn");
}

std::vector<std::string> VelodyneDecoder::findings() const {
    std::vector<std::string> findings;
    if (mended_.count > 0) findings.push_back(interpolatedTimes(mended_.of("packet")));
    if (untimed_.count > 0) findings.push_back(noTimes(untimed_.of("turn")));
    return findings;
}

void VelodyneDecoder::keep(const std::uint8_t* payload, std::size_t from, std::size_t to,
                           double time_s, int turned) {
    if (from == to) return;
    std::vector<std::uint8_t> bytes(payload, payload + sizeof(Packet));
    for (std::size_t b = 0; b < kBlocks; ++b)
        if (b < from || b >= to) bytes[kBlockBytes * b] = bytes[kBlockBytes * b + 1] = 0;
    packets_.emplace_back();
    std::memcpy(static_cast<void*>(&packets_.back()), bytes.data(), bytes.size());
    times_s_.push_back(time_s);
    places_.push_back(static_cast<double>(turned) / kTurn);
}

std::vector<double> VelodyneDecoder::startsOfPackets() {
    constexpr double kTolerance = 0.25;  // a recorder's clock may tell the times
    std::vector<double> starts_s;
    for (const double time_s : times_s_) starts_s.push_back(time_s - times_s_.front());
    const auto mended = mendTurnTimes(places_, kTolerance, starts_s);
    if (mended && *mended > 0) mended_.add(*mended, made_);
    if (!mended) {
        untimed_.add(1, made_);
        starts_s.assign(starts_s.size(), 0);
    }
    return starts_s;
}

void VelodyneDecoder::endTurn(bool partial) {
    const bool enough = !packets_.empty() && (!partial || turned_ >= kTurn / 2);
    if (enough) {
        const std::vector<double> starts_s = startsOfPackets();
        ++made_;
        Scan scan;
        decodeVelodynePackets(packets_, starts_s, model_.calibration, model_.layout, scan);
        // The stamp is the first point's time, not that of the packet which it shares.
        const double lead_s = scan.times_s.empty() ? 0 : static_cast<double>(scan.times_s.front());
        for (float& time_s : scan.times_s) time_s -= static_cast<float>(lead_s);
        scan.stamp_s = times_s_.front() + lead_s;
        scan.time = timeOf(scan.stamp_s);
        scans_.push_back(std::move(scan));
    }
    packets_.clear();
    times_s_.clear();
    places_.clear();
    if (made_ == 0) turnedInAll_ += turned_;
    turned_ = 0;
}

std::optional<Scan> VelodyneDecoder::take() {
    if (scans_.empty()) return {};
    Scan scan = std::move(scans_.front());
    scans_.pop_front();
    return scan;
}
}  // namespace

std::unique_ptr<PacketDecoder> velodyneDecoder(const std::string& calibrationFile) {
    return std::make_unique<VelodyneDecoder>(calibrationFile);
}
}  // namespace delio::io
