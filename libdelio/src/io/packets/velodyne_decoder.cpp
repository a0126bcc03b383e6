#include <cmath>
#include <cstddef>
#include <cstring>
#include <deque>
#include <vector>

#include "../drive_clock.h"
#include "../velodyne_packets.h"
#include "delio/core/error.h"
#include "packet_decoder.h"
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
    void add(const std::uint8_t* payload, std::size_t bytes, double received_s) override;
    void finish() override { endTurn(true); }
    std::optional<Scan> take() override;
    std::string sensor() const override {
        return model_.name.empty() ? "" : "Velodyne " + model_.name;
    }

 private:
    /** Blocks `from` to before `to` of a packet are of this turn. */
    void keep(const std::uint8_t* payload, std::size_t from, std::size_t to, double time_s);
    void endTurn(bool partial);

    std::string calibrationFile_;
    VelodyneModel model_;
    VelodyneClock clock_;
    std::vector<Packet> packets_;
    std::vector<double> times_s_;  //!< Unix time of each packet
    int azimuth_ = -1;             //!< of the last block
    int turned_ = 0;               //!< since the turn began
    bool first_ = true;            //!< the recording may begin within this turn
    std::deque<Scan> scans_;
};

void VelodyneDecoder::add(const std::uint8_t* payload, std::size_t bytes, double received_s) {
    if (!takes(bytes)) throw Error("a Velodyne's packet of " + std::to_string(bytes) + " bytes");
    const std::string name = velodyneModelName(payload);
    if (model_.name.empty()) model_ = velodyneModel(name, calibrationFile_);
    if (model_.name != name)
        throw Error("a packet of a Velodyne " + name + " among those of a " + model_.name);
    std::uint32_t clock_us = 0;
    std::memcpy(&clock_us, payload + kBlocks * kBlockBytes, sizeof(clock_us));
    const double time_s = clock_.timeOf(clock_us, received_s);
    std::size_t from = 0;
    for (std::size_t b = 0; b < kBlocks; ++b) {
        const std::uint8_t* const block = payload + kBlockBytes * b;
        const int azimuth = block[2] | block[3] << 8;
        if (azimuth >= kTurn) continue;
        if (azimuth_ >= 0 && azimuth < azimuth_ - kTurn / 2) {
            keep(payload, from, b, time_s);
            endTurn(first_);
            first_ = false;
            from = b;
        } else if (azimuth_ >= 0) {
            turned_ += std::max(0, azimuth - azimuth_);
        }
        azimuth_ = azimuth;
    }
    keep(payload, from, kBlocks, time_s);
    if (packets_.size() >= kMostPackets) endTurn(false);
}

void VelodyneDecoder::keep(const std::uint8_t* payload, std::size_t from, std::size_t to,
                           double time_s) {
    if (from == to) return;
    std::vector<std::uint8_t> bytes(payload, payload + sizeof(Packet));
    for (std::size_t b = 0; b < kBlocks; ++b)
        if (b < from || b >= to) bytes[kBlockBytes * b] = bytes[kBlockBytes * b + 1] = 0;
    packets_.emplace_back();
    std::memcpy(static_cast<void*>(&packets_.back()), bytes.data(), bytes.size());
    times_s_.push_back(time_s);
}

void VelodyneDecoder::endTurn(bool partial) {
    const bool enough = !packets_.empty() && (!partial || turned_ >= kTurn / 2);
    if (enough) {
        std::vector<double> starts_s;
        for (const double time_s : times_s_) starts_s.push_back(time_s - times_s_.front());
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
