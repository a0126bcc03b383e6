#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "delio/odometry/imu.h"
#include "delio/odometry/scan.h"

namespace delio::io {
/** Makes scans, a turn of the sensor each, of the UDP payloads that a LiDAR sends. */
class PacketDecoder {
 public:
    PacketDecoder() = default;
    virtual ~PacketDecoder() = default;
    PacketDecoder(const PacketDecoder&) = delete;
    PacketDecoder& operator=(const PacketDecoder&) = delete;

    /** True where a payload of this size is one of the sensor's data packets. */
    virtual bool takes(std::size_t bytes) const = 0;

    /** One data packet; `received_s`: Unix seconds at which it was recorded. False where another
     *  sensor sent it, so that it is left out. Throws Error where it is of another model or layout,
     *  and where all packets are of another sensor. */
    virtual bool add(const std::uint8_t* payload, std::size_t bytes, double received_s) = 0;

    /** There are no more packets: what there is of the last turn is a scan, too, if it is at least
     *  half of one. Throws Error where there were packets, but no scan was made of them. */
    virtual void finish() = 0;

    /** The next complete scan, if there is one: points, rings, times, stamp_s and time (Unix
     *  seconds); the index is the caller's. */
    virtual std::optional<Scan> take() = 0;

    /** True where the scan that was taken last ended with the last packet, which it holds. False:
     *  that packet is of the next turn. */
    virtual bool endedWhole() const { return false; }

    /** A payload of the sensor's address that is no data packet; false where it holds no sample of
     *  the sensor's IMU. */
    virtual bool addImu(const std::uint8_t* /*payload*/, std::size_t /*bytes*/) { return false; }

    /** IMU samples since the last call, in their order; stamps as those of the scans. */
    virtual std::vector<ImuSample> takeImu() { return {}; }

    /** e.g. "Velodyne VLP-16"; empty until it is known. */
    virtual std::string sensor() const = 0;

    /** Ignored or corrected data, one line per kind. */
    virtual std::vector<std::string> findings() const { return {}; }
};

/** `calibrationFile`: an .xml or .yaml as MRPT reads it, of a VLS-128 a table of its beam angles;
 *  empty: the model's usual one. */
std::unique_ptr<PacketDecoder> velodyneDecoder(const std::string& calibrationFile);

/** `anglesFile`: the sensor's own angles, as Hesai's tools write them (channel, elevation,
 * azimuth); empty: the model's default ones. */
std::unique_ptr<PacketDecoder> hesaiDecoder(const std::string& anglesFile);

/** The angles are those of a DIFOP packet, which may come behind other packets, or of `anglesFile`
 * (a line with elevation and azimuth for each laser), where it is not empty. */
std::unique_ptr<PacketDecoder> robosenseDecoder(const std::string& anglesFile);

/** Maker of the sensor that sent a packet: "velodyne", "hesai" or "robosense"; empty: another one.
 *  Ouster's packets have no mark. */
std::string makerOf(const std::uint8_t* packet, std::size_t bytes);

/** A decoder for a maker that makerOf() names. */
std::unique_ptr<PacketDecoder> decoderFor(const std::string& maker, const std::string& sensorFile);

/** A decoder that takes the first packet's maker for that of all. */
std::unique_ptr<PacketDecoder> recognisingDecoder(const std::string& sensorFile);

/** `json`: the sensor's description as Ouster's tools write it; `name`: of its source, for errors.
 *  Throws Error where it cannot be understood. */
std::unique_ptr<PacketDecoder> ousterDecoder(const std::string& json, const std::string& name);
}  // namespace delio::io
