#include <mrpt/maps/CPointsMapXYZI.h>

#include <cmath>
#include <deque>
#include <optional>

#include "../drive_clock.h"
#include "delio/core/error.h"
#include "ouster_beams.h"
#include "ouster_frame.h"
#include "packet_decoder.h"

namespace delio::io {
namespace {
/** Takes the first return, the strongest. Points come column by column, so in the order of time,
 *  and upper rows first; their intensity is the reflectivity, 255 being 1. Columns that the sensor
 *  calls invalid and pixels without a return are left out, and so is what comes of a turn after the
 *  next one began. */
class OusterDecoder : public PacketDecoder {
 public:
    OusterDecoder(const std::string& json, const std::string& name)
        : info_(readOusterInfo(json, name)), name_(name), beams_(info_) {}

    bool takes(std::size_t bytes) const override { return bytes == info_.packetBytes(); }
    void add(const std::uint8_t* payload, std::size_t bytes, double received_s) override;
    void finish() override { endFrame(true); }
    std::optional<Scan> take() override;
    std::string sensor() const override {
        return info_.product.empty() ? "Ouster" : "Ouster " + info_.product;
    }

 private:
    /** Seconds from the sensor's clock to Unix time: none for one that keeps that itself. */
    void setClock(std::uint64_t time_ns, double received_s);
    void endFrame(bool partial);
    Scan scanOf(const OusterFrame& frame) const;

    OusterInfo info_;
    std::string name_;
    OusterBeams beams_;
    std::optional<OusterFrame> frame_;
    std::optional<double> clockOffset_s_;
    bool first_ = true;  //!< the recording may begin within this frame
    std::deque<Scan> scans_;
};

void OusterDecoder::setClock(std::uint64_t time_ns, double received_s) {
    constexpr std::uint64_t kUnix_ns = 1000000000ULL * 1000000000ULL;
    if (time_ns >= kUnix_ns)
        clockOffset_s_ = 0;
    else if (!clockOffset_s_)
        clockOffset_s_ = received_s - 1e-9 * static_cast<double>(time_ns);
}

void OusterDecoder::add(const std::uint8_t* payload, std::size_t bytes, double received_s) {
    if (!takes(bytes))
        throw Error("an Ouster's packet of " + std::to_string(bytes) + " bytes; '" + name_ +
                    "' describes one of " + std::to_string(info_.packetBytes()));
    const OusterPacket packet(info_, payload);
    for (std::size_t column = 0; column < info_.columnsPerPacket; ++column) {
        if (!packet.valid(column)) continue;
        if (packet.place(column) >= info_.columns)
            throw Error("an Ouster's packet has column " + std::to_string(packet.place(column)) +
                        "; '" + name_ + "' has " + std::to_string(info_.columns));
        const std::uint16_t number = packet.frameOf(column);
        if (frame_ && number != frame_->number) {
            // Numbers begin anew after 65535. An older one is late, a much older one a restart.
            constexpr int kLate = 16;
            const auto ahead =
                static_cast<std::int16_t>(static_cast<std::uint16_t>(number - frame_->number));
            if (ahead < 0 && ahead > -kLate) continue;
            endFrame(first_);
            first_ = false;
        }
        if (!frame_) {
            setClock(packet.time_ns(column), received_s);
            frame_.emplace(info_);
            frame_->number = number;
        }
        packet.copyTo(*frame_, column);
    }
}

void OusterDecoder::endFrame(bool partial) {
    if (frame_ && (!partial || 2 * frame_->count >= info_.columnsUsed))
        scans_.push_back(scanOf(*frame_));
    frame_.reset();
}

Scan OusterDecoder::scanOf(const OusterFrame& frame) const {
    std::size_t count = 0;
    for (const std::uint32_t range_mm : frame.ranges_mm) count += range_mm > 0;
    auto points = mrpt::maps::CPointsMapXYZI::Create();
    points->resize(count);
    Scan scan;
    scan.rings.reserve(count);
    scan.times_s.reserve(count);
    std::optional<std::uint64_t> start_ns;
    std::size_t i = 0;
    for (std::size_t column = 0; column < info_.columns; ++column) {
        if (!frame.received[column]) continue;
        if (!start_ns) start_ns = frame.times_ns[column];
        const auto since_ns = static_cast<std::int64_t>(frame.times_ns[column] - *start_ns);
        const auto since_s = static_cast<float>(1e-9 * static_cast<double>(since_ns));
        for (std::size_t row = 0; row < info_.rows; ++row) {
            const std::size_t pixel = column * info_.rows + row;
            if (frame.ranges_mm[pixel] == 0) continue;
            const Eigen::Vector3f point = beams_.point(pixel, frame.ranges_mm[pixel]);
            points->setPointFast(i, point.x(), point.y(), point.z());
            points->setPointIntensity(i++,
                                      static_cast<float>(frame.reflectivities[pixel]) / 255.0F);
            scan.rings.push_back(static_cast<std::uint16_t>(row));
            scan.times_s.push_back(since_s);
        }
    }
    points->mark_as_modified();
    scan.points = points;
    scan.stamp_s = 1e-9 * static_cast<double>(start_ns.value_or(0)) + clockOffset_s_.value_or(0);
    scan.time = timeOf(scan.stamp_s);
    return scan;
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
}  // namespace delio::io
