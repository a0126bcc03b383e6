#include "velodyne.h"

#include <mrpt/maps/CPointsMapXYZI.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/portable_math.h"
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
 *  beside them show which. */
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

/** The usual time from one packet to the next in microseconds; 0 where no clock shows it. */
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

/** The block with the first returns for the second returns in block `b`, if any. It has the same
 *  azimuth; the packet's return-mode byte has another meaning on an HDL-64E. */
const Block* firstReturns(const Packet& packet, int b) {
    const Block& block = packet.blocks[b];
    for (int i = b - 1; i >= 0 && packet.blocks[i].rotation() == block.rotation(); --i)
        if (packet.blocks[i].header() == block.header()) return &packet.blocks[i];
    return nullptr;
}

/** Where the beams of a packet point to at azimuth 0: turned by how far the sensor gets between two
 *  azimuths until a return is measured, and by its laser's correction. */
struct Heading {
    double sine = 0, cosine = 1;
};

class Decoder {
 public:
    Decoder(const std::vector<LaserCalibration>& lasers, const VelodyneLayout& layout)
        : lasers_(lasers), layout_(layout), angleUnit_(radiansPerUnit(lasers)) {}

    /** `start_s`: from the stamp to the packet, `period_s`: until the next one; with a period of 0
     *  points get no times. Otherwise points get their block's time, or their laser's. */
    void decode(const Packet& packet, double start_s, double period_s, bool ofLaser) {
        turnTo(turnPerBlock(packet));
        const int shots = ofLaser ? shotsOf(packet) : kBlocks;
        int shot = 0;
        for (int b = 0; b < kBlocks; ++b) {
            const Block& block = packet.blocks[b];
            if (b > 0 && (!ofLaser || block.rotation() != packet.blocks[b - 1].rotation())) ++shot;
            const bool lower = lasers_.size() == 64 && block.header() == Velodyne::LOWER_BANK;
            if (!lower && block.header() != Velodyne::UPPER_BANK) continue;
            const std::size_t before = points_.size();
            decode(block, firstReturns(packet, b), lower ? kReturns : 0);
            if (period_s <= 0) continue;
            pointTimes_.resize(points_.size(),
                               static_cast<float>(start_s + period_s * shot / shots));
            for (std::size_t i = before; ofLaser && i < points_.size(); ++i)
                pointTimes_[i] += static_cast<float>(points_[i].share * period_s / shots);
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
        double share;  //!< of the way to the next azimuth
    };

    static int shotsOf(const Packet& packet) {
        int shots = 1;
        for (int b = 1; b < kBlocks; ++b)
            shots += packet.blocks[b].rotation() != packet.blocks[b - 1].rotation();
        return shots;
    }

    std::size_t perFiring() const { return std::min(kReturns, lasers_.size()); }

    double shareOf(std::size_t k) const {
        // A VLP-16 fires twice within a block.
        const std::size_t firings = kReturns / perFiring(), before = k / perFiring();
        return (static_cast<double>(before) + layout_.firing.share(k % perFiring())) /
               static_cast<double>(firings);
    }

    /** `turn`: 0.01 deg from one azimuth to the next. */
    void turnTo(int turn) {
        if (turn == turn_) return;
        turn_ = turn;
        for (std::size_t k = 0; k < 2 * kReturns; ++k) {
            const std::size_t inBlock = k % kReturns;
            const std::size_t laser = inBlock % perFiring() + (k < kReturns ? 0 : kReturns);
            if (laser >= lasers_.size()) continue;
            const double angle = mrpt::DEG2RAD(0.01 * turn * shareOf(inBlock)) -
                                 angleUnit_ * lasers_[laser].azimuthCorrection;
            headings_[k] = {portable::sin(angle), portable::cos(angle)};
        }
    }

    void decode(const Block& block, const Block* first, std::size_t firstLaser) {
        const double angle = mrpt::DEG2RAD(0.01 * block.rotation());
        const Heading turned{portable::sin(angle), portable::cos(angle)};
        for (std::size_t k = 0; k < kReturns; ++k) {
            const auto& measured = block.laser_returns[k];
            if (measured.distance() == 0) continue;
            if (first && first->laser_returns[k].distance() == measured.distance()) continue;
            const Heading& beam = headings_[k + firstLaser];
            const Heading heading{turned.sine * beam.cosine + turned.cosine * beam.sine,
                                  turned.cosine * beam.cosine - turned.sine * beam.sine};
            add(firstLaser + k % perFiring(), heading, measured, shareOf(k));
        }
    }

    /** Velodyne's azimuth is clockwise, from the front to the right. The offsets of the laser are
     *  at right angles to the beam. */
    void add(std::size_t laser, const Heading& heading, const Velodyne::laser_return_t& measured,
             double share) {
        const LaserCalibration& c = lasers_[laser];
        const double range = layout_.unit_m * measured.distance() + c.distanceCorrection;
        if (!(range >= layout_.minRange && range <= layout_.maxRange)) return;
        const double flat =
            range * c.cosVertCorrection - c.verticalOffsetCorrection * c.sinVertCorrection;
        const double up =
            range * c.sinVertCorrection + c.verticalOffsetCorrection * c.cosVertCorrection;
        const double sideways = c.horizontalOffsetCorrection;
        points_.push_back({static_cast<float>(flat * heading.cosine + sideways * heading.sine),
                           static_cast<float>(sideways * heading.cosine - flat * heading.sine),
                           static_cast<float>(up),
                           static_cast<float>(measured.intensity()) / 255.0F, share});
        rings_.push_back(static_cast<std::uint16_t>(laser));
    }

    const std::vector<LaserCalibration>& lasers_;
    VelodyneLayout layout_;
    double angleUnit_;
    int turn_ = -1;
    std::array<Heading, 2 * kReturns> headings_;
    std::vector<Point> points_;
    std::vector<std::uint16_t> rings_;
    std::vector<float> pointTimes_;
};

void checkCalibration(const std::vector<LaserCalibration>& lasers) {
    if (lasers.empty())
        throw Error(
            "a Velodyne scan has no calibration; record it with the calibration file of the "
            "sensor");
    if (lasers.size() != 16 && lasers.size() != 32 && lasers.size() != 64)
        throw Error("a Velodyne scan with " + std::to_string(lasers.size()) +
                    " lasers is not supported; 16, 32 and 64 are");
}

/** The usual step; 0 if unknown. */
double medianStep(const std::vector<double>& values) {
    if (values.size() < 2) return 0;
    std::vector<double> steps;
    for (std::size_t i = 1; i < values.size(); ++i) steps.push_back(values[i] - values[i - 1]);
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    return std::max(0.0, *middle);
}
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
    checkCalibration(lasers);
    Decoder decoder(lasers,
                    {firingTimes(lasers.size()), static_cast<double>(Velodyne::DISTANCE_RESOLUTION),
                     minRange, maxRange});
    const double period_s = 1e-6 * packetPeriod_us(packets);
    for (std::size_t i = 0; i < packets.size(); ++i) {
        // After a clock that was set in between, packets are taken as evenly spaced.
        constexpr double kOff_s = 0.05;
        const double even_s = static_cast<double>(i) * period_s;
        const double told_s = 1e-6 * microsecondsBetween(packets.front(), packets[i]);
        decoder.decode(packets[i], std::abs(told_s - even_s) < kOff_s ? told_s : even_s, period_s,
                       false);
    }
    decoder.moveTo(scan);
}

void decodeVelodynePackets(const std::vector<Packet>& packets, const std::vector<double>& starts_s,
                           const mrpt::obs::VelodyneCalibration& calibration,
                           const VelodyneLayout& layout, Scan& scan) {
    checkCalibration(calibration.laser_corrections);
    Decoder decoder(calibration.laser_corrections, layout);
    const double period_s = medianStep(starts_s);
    for (std::size_t i = 0; i < packets.size(); ++i)
        decoder.decode(packets[i], starts_s[i], period_s, true);
    decoder.moveTo(scan);
}
}  // namespace delio::io
