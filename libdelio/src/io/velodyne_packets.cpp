#include "velodyne_packets.h"

#include <mrpt/maps/CPointsMapXYZI.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "delio/core/error.h"

namespace delio::io {
using Velodyne = mrpt::obs::CObservationVelodyneScan;
using Packet = Velodyne::TVelodyneRawPacket;
using Block = Velodyne::raw_block_t;
using LaserCalibration = mrpt::obs::VelodyneCalibration::PerLaserCalib;

namespace {
constexpr int kBlocks = Velodyne::BLOCKS_PER_PACKET;
constexpr std::size_t kReturns = Velodyne::SCANS_PER_BLOCK;
constexpr int kTurn = Velodyne::ROTATION_MAX_UNITS;

/** MRPT keeps the angles of an XML file in degrees and those of a YAML file in radians; the sines
 *  beside them tell which. */
double radiansPerUnit(const std::vector<LaserCalibration>& lasers) {
    const auto fits = [&](double unit) {
        return std::all_of(lasers.begin(), lasers.end(), [&](const LaserCalibration& laser) {
            return std::abs(std::sin(unit * laser.verticalCorrection) - laser.sinVertCorrection) <
                   1e-6;
        });
    };
    return !fits(mrpt::DEG2RAD(1.0)) && fits(1) ? 1 : mrpt::DEG2RAD(1.0);
}

/** Turn from one block to the next in 0.01 deg: the median, since a packet may hold a gap; 0 where
 *  nothing turns. Blocks that share an azimuth (dual return, two banks) do not count. */
int turnPerBlock(const Packet& packet) {
    std::vector<int> turns;
    for (int b = 1; b < kBlocks; ++b) {
        const int turn =
            (packet.blocks[b].rotation() - packet.blocks[b - 1].rotation() + 2 * kTurn) % kTurn;
        if (turn != 0) turns.push_back(turn);
    }
    if (turns.empty()) return 0;
    const auto middle = turns.begin() + static_cast<std::ptrdiff_t>(turns.size() / 2);
    std::nth_element(turns.begin(), middle, turns.end());
    return *middle;
}

/** Microseconds from `earlier` to `later`, negative where their order is the other one: a packet's
 *  clock counts from the full hour. */
double microsecondsBetween(const Packet& earlier, const Packet& later) {
    constexpr double kHour_us = 3600e6;
    return std::remainder(
        static_cast<double>(later.gps_timestamp()) - static_cast<double>(earlier.gps_timestamp()),
        kHour_us);
}

/** The usual time from one packet to the next in microseconds; 0 where their clocks do not tell. */
double packetPeriod_us(const std::vector<Packet>& packets) {
    if (packets.size() < 2) return 0;
    std::vector<double> periods;
    for (std::size_t i = 1; i < packets.size(); ++i)
        periods.push_back(microsecondsBetween(packets[i - 1], packets[i]));
    const auto middle = periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2);
    std::nth_element(periods.begin(), middle, periods.end());
    constexpr double kSlowest_us = 10000;
    return *middle > 0 && *middle < kSlowest_us ? *middle : 0;
}

/** The block with the first returns of those that block `b` holds second returns of, or none. It is
 *  told by its azimuth: the packet's byte for the return mode is another thing on an HDL-64E. */
const Block* firstReturns(const Packet& packet, int b) {
    const Block& block = packet.blocks[b];
    for (int i = b - 1; i >= 0 && packet.blocks[i].rotation() == block.rotation(); --i)
        if (packet.blocks[i].header() == block.header()) return &packet.blocks[i];
    return nullptr;
}

class Decoder {
 public:
    Decoder(const std::vector<LaserCalibration>& lasers, double minRange, double maxRange)
        : lasers_(lasers),
          times_(firingTimes(lasers.size())),
          angleUnit_(radiansPerUnit(lasers)),
          minRange_(minRange),
          maxRange_(maxRange) {}

    /** `start_s`: from the stamp to the packet, `period_s`: until the next one; with a period of 0
     *  points get no times. */
    void decode(const Packet& packet, double start_s, double period_s) {
        const double turn = turnPerBlock(packet);
        for (int b = 0; b < kBlocks; ++b) {
            const Block& block = packet.blocks[b];
            const bool lower = lasers_.size() == 64 && block.header() == Velodyne::LOWER_BANK;
            const std::size_t before = points_.size();
            if (lower || block.header() == Velodyne::UPPER_BANK)
                decode(block, firstReturns(packet, b), lower ? kReturns : 0, turn);
            if (period_s > 0)
                pointTimes_.insert(pointTimes_.end(), points_.size() - before,
                                   static_cast<float>(start_s + period_s * b / kBlocks));
        }
    }

    void moveTo(Scan& scan) {
        auto points = mrpt::maps::CPointsMapXYZI::Create();
        points->resize(points_.size());
        for (std::size_t i = 0; i < points_.size(); ++i) {
            points->setPointFast(i, points_[i].x, points_[i].y, points_[i].z);
            points->setPointIntensity(i, points_[i].intensity);
        }
        scan.points = points;
        scan.rings = std::move(rings_);
        scan.times_s = std::move(pointTimes_);
    }

 private:
    struct Point {
        float x, y, z, intensity;
    };

    void decode(const Block& block, const Block* first, std::size_t firstLaser, double turn) {
        // A VLP-16 fires twice within a block.
        const std::size_t perFiring = std::min(kReturns, lasers_.size());
        const std::size_t firings = kReturns / perFiring;
        for (std::size_t k = 0; k < kReturns; ++k) {
            const auto& measured = block.laser_returns[k];
            if (measured.distance() == 0) continue;
            if (first && first->laser_returns[k].distance() == measured.distance()) continue;
            const std::size_t firing = k / perFiring, laser = k % perFiring;
            const double share =
                (static_cast<double>(firing) + times_.share(laser)) / static_cast<double>(firings);
            const double azimuth = mrpt::DEG2RAD(0.01 * (block.rotation() + turn * share));
            add(firstLaser + laser, azimuth, measured);
        }
    }

    /** Velodyne's azimuth is clockwise, from the front to the right. The offsets of the laser are
     *  at right angles to the beam. */
    void add(std::size_t laser, double azimuth, const Velodyne::laser_return_t& measured) {
        const LaserCalibration& c = lasers_[laser];
        const auto unit = static_cast<double>(Velodyne::DISTANCE_RESOLUTION);
        const double range = unit * measured.distance() + c.distanceCorrection;
        if (!(range >= minRange_ && range <= maxRange_)) return;
        azimuth -= angleUnit_ * c.azimuthCorrection;
        const double flat =
            range * c.cosVertCorrection - c.verticalOffsetCorrection * c.sinVertCorrection;
        const double up =
            range * c.sinVertCorrection + c.verticalOffsetCorrection * c.cosVertCorrection;
        const double sideways = c.horizontalOffsetCorrection;
        const double cosine = std::cos(azimuth), sine = std::sin(azimuth);
        points_.push_back({static_cast<float>(flat * cosine + sideways * sine),
                           static_cast<float>(sideways * cosine - flat * sine),
                           static_cast<float>(up),
                           static_cast<float>(measured.intensity()) / 255.0F});
        rings_.push_back(static_cast<std::uint16_t>(laser));
    }

    const std::vector<LaserCalibration>& lasers_;
    FiringTimes times_;
    double angleUnit_, minRange_, maxRange_;
    std::vector<Point> points_;
    std::vector<std::uint16_t> rings_;
    std::vector<float> pointTimes_;
};
}  // namespace

FiringTimes firingTimes(std::size_t lasers) {
    if (lasers == 16) return {2.304, 55.296};
    if (lasers == 32) return {1.152, 46.08};
    return {};
}

void decodeVelodynePackets(const std::vector<Packet>& packets,
                           const mrpt::obs::VelodyneCalibration& calibration, double minRange,
                           double maxRange, Scan& scan) {
    const auto& lasers = calibration.laser_corrections;
    if (lasers.empty())
        throw Error(
            "a Velodyne scan without its calibration; record it with a calibration file of the "
            "sensor");
    if (lasers.size() != 16 && lasers.size() != 32 && lasers.size() != 64)
        throw Error("a Velodyne scan of " + std::to_string(lasers.size()) +
                    " lasers; models of 16, 32 and 64 are known");
    Decoder decoder(lasers, minRange, maxRange);
    const double period_s = 1e-6 * packetPeriod_us(packets);
    for (std::size_t i = 0; i < packets.size(); ++i) {
        // A clock that was set in between does not tell: then packets are taken as evenly spaced.
        constexpr double kOff_s = 0.05;
        const double even_s = static_cast<double>(i) * period_s;
        const double told_s = 1e-6 * microsecondsBetween(packets.front(), packets[i]);
        decoder.decode(packets[i], std::abs(told_s - even_s) < kOff_s ? told_s : even_s, period_s);
    }
    decoder.moveTo(scan);
}
}  // namespace delio::io
