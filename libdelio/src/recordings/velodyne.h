#pragma once
#include <mrpt/obs/CObservationVelodyneScan.h>
#include <mrpt/obs/VelodyneCalibration.h>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "delio/odometry/scan.h"
#include "packet_clock.h"
#include "packet_decoder.h"

namespace delio::io {
/** Microseconds from the first laser of a firing to `laser` (counted from 0), and from one firing
 *  to the next, of the model with so many lasers: what a laser's azimuth lags behind depends on. */
struct FiringTimes {
    double laser_us = 0;
    double cycle_us = 1;
    std::size_t atOnce = 1;  //!< lasers that fire together

    double share(std::size_t laser) const {
        const std::size_t before = laser / atOnce;
        return static_cast<double>(before) * laser_us / cycle_us;
    }
};

/** 16: VLP-16, 32: HDL-32E. The azimuth corrections of an HDL-64E hold its lag already, and any
 *  other count is not known: no lag. */
FiringTimes firingTimes(std::size_t lasers);

/** Decodes Velodyne's data packets: all 32 returns of each of the 12 blocks. (MRPT 2.5.8's own
 *  generatePointCloud() reads the first 16: half of a VLP-16's points, half of the rings of an
 *  HDL-32E and HDL-64E; it leaves out azimuth corrections as well.)
 *
 *  Fills `points` (a CPointsMapXYZI: metres, sensor frame, x forward, y left, z up; intensity 0 to
 *  1, in the order of the packets) and `rings` (laser number as in the calibration) of `scan`, and
 * `times_s` from the first packet, which the observation is stamped with, to the block of each
 * point, where the packets' clocks run. Returns nearer than `minRange` or farther than `maxRange`
 * (metres) are left out, and so is a second return that only repeats the first. Blocks with an
 * unknown header are passed over. Throws Error where the calibration is missing or is not of 16, 32
 * or 64 lasers. */
void decodeVelodynePackets(
    const std::vector<mrpt::obs::CObservationVelodyneScan::TVelodyneRawPacket>& packets,
    const mrpt::obs::VelodyneCalibration& calibration, double minRange, double maxRange,
    Scan& scan);

/** Properties of a sensor that a decoder needs besides its calibration. */
struct VelodyneLayout {
    FiringTimes firing;
    double unit_m = 0.002;  //!< of a return's distance
    double minRange = 0.5;  //!< metres
    double maxRange = 300;
};

/** As above, with the times of the caller: `starts_s`, one a packet, from the scan's stamp.
 *  `times_s` are those of each point's laser; blocks that share an azimuth were measured at once.
 */
void decodeVelodynePackets(
    const std::vector<mrpt::obs::CObservationVelodyneScan::TVelodyneRawPacket>& packets,
    const std::vector<double>& starts_s, const mrpt::obs::VelodyneCalibration& calibration,
    const VelodyneLayout& layout, Scan& scan);

/** A Velodyne that a data packet can be of. */
struct VelodyneModel {
    std::string name;  //!< e.g. "VLP-16"
    mrpt::obs::VelodyneCalibration calibration;
    VelodyneLayout layout;
};

/** True for a data packet (1206 bytes) of a VLS-128: by the blocks of its third and fourth bank, or
 *  by the factory byte. */
bool isVls128(const std::uint8_t* packet);

/** A decoder of all other Velodynes. */
std::unique_ptr<PacketDecoder> smallVelodyneDecoder(const std::string& calibrationFile);

/** Of the sensor that sent a data packet (1206 bytes): "HDL-64E" by its blocks of the lower bank
 *  of two, others by the factory byte. Throws Error for a VLS-128, one that is not known, and one
 *  that is known but not decoded. */
std::string velodyneModelName(const std::uint8_t* packet);

/** `calibrationFile`: an .xml or .yaml as MRPT reads it; empty: the model's usual one. Throws Error
 *  where that cannot be read, is of another number of lasers, or there is no usual one. */
VelodyneModel velodyneModel(const std::string& name, const std::string& calibrationFile);

/** Unix times of a Velodyne's packets. Its clock counts microseconds since the full hour; the hour
 *  is that of the recorder. */
class VelodyneClock {
 public:
    double timeOf(std::uint32_t clock_us, double received_s) {
        return clock_.timeOf(1e-6 * static_cast<double>(clock_us), received_s);
    }

 private:
    PacketClock clock_{3600};
};
}  // namespace delio::io
