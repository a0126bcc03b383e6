#pragma once
#include <mrpt/obs/CObservationVelodyneScan.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "delio/core/error.h"
#include "recordings/decode_observation.h"

/** A Velodyne between four walls: packets whose every point is known. */
namespace delio::spinner_test {
using mrpt::obs::CObservationVelodyneScan;
using mrpt::obs::VelodyneCalibration;

/** Walls about the sensor, at another distance on each side: no mirrored azimuth fits. */
constexpr double kFront = 8, kBack = -6, kLeft = 9, kRight = -5;

inline double distanceFromWalls(float x, float y) {
    const double X = static_cast<double>(x), Y = static_cast<double>(y);
    return std::min(std::min(std::abs(X - kFront), std::abs(X - kBack)),
                    std::min(std::abs(Y - kLeft), std::abs(Y - kRight)));
}

inline double rangeToWalls(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) {
    const double x = ((ray.x() > 0 ? kFront : kBack) - from.x()) / ray.x();
    const double y = ((ray.y() > 0 ? kLeft : kRight) - from.y()) / ray.y();
    return std::min(std::abs(x), std::abs(y));
}

/** A sensor that turns evenly between the walls, `turn` hundredths of a degree a shot. */
struct Spinner {
    VelodyneCalibration calibration;
    int turn = 40;
    bool dual = false;  //!< the returns twice; laser 3's second one is 1 m behind the wall
    double angleUnit = M_PI / 180;  //!< of the calibration's azimuth corrections

    std::size_t lasers() const { return calibration.laser_corrections.size(); }
    int shots() const { return 36000 / turn; }

    /** Part of the turn to the next shot at which return `k` of a block fires. */
    double share(int k) const {
        if (lasers() == 16) return (k / 16 * 55.296 + k % 16 * 2.304) / 110.592;
        return lasers() == 32 ? k * 1.152 / 46.08 : 0;
    }

    double range(std::size_t laser, double turned_deg) const {
        const auto& c = calibration.laser_corrections[laser];
        const double azimuth = turned_deg * M_PI / 180 - angleUnit * c.azimuthCorrection;
        const Eigen::Vector3d ahead(std::cos(azimuth), -std::sin(azimuth), 0);
        const Eigen::Vector3d left(std::sin(azimuth), std::cos(azimuth), 0), up(0, 0, 1);
        const Eigen::Vector3d ray = c.cosVertCorrection * ahead + c.sinVertCorrection * up;
        const Eigen::Vector3d across = c.cosVertCorrection * up - c.sinVertCorrection * ahead;
        return rangeToWalls(
            c.horizontalOffsetCorrection * left + c.verticalOffsetCorrection * across, ray);
    }

    CObservationVelodyneScan scan() const {
        CObservationVelodyneScan scan;
        scan.calibration = calibration;
        scan.minRange = 0.5;
        std::vector<std::array<std::uint8_t, 100>> blocks;
        for (int shot = 0; shot < shots(); ++shot)
            for (int part = 0; part < (lasers() == 64 || dual ? 2 : 1); ++part)
                blocks.push_back(block(shot, part));
        scan.scan_packets.resize(blocks.size() / 12);
        for (std::size_t i = 0; i < blocks.size(); ++i) {
            auto* packet = reinterpret_cast<std::uint8_t*>(&scan.scan_packets[i / 12]);
            std::memcpy(packet + i % 12 * 100, blocks[i].data(), 100);
            const auto time_us = static_cast<std::uint32_t>(i / 12 * 1000);
            std::memcpy(packet + 1200, &time_us, 4);
            packet[1204] = dual ? 0x39 : 0x37;
            packet[1205] = lasers() == 16 ? 0x22 : lasers() == 32 ? 0x21 : 0;
        }
        return scan;
    }

    std::array<std::uint8_t, 100> block(int shot, int part) const {
        const bool lower = lasers() == 64 && part == 1;
        std::array<std::uint8_t, 100> bytes{};
        const std::uint16_t header = lower ? 0xDDFF : 0xEEFF;
        const auto rotation = static_cast<std::uint16_t>(shot * turn);
        std::memcpy(bytes.data(), &header, 2);
        std::memcpy(&bytes[2], &rotation, 2);
        for (int k = 0; k < 32; ++k) {
            const std::size_t laser =
                static_cast<std::size_t>(k) % std::min<std::size_t>(32, lasers()) +
                (lower ? 32 : 0);
            const double behind = dual && part == 1 && laser == 3 ? 1 : 0;
            const double metres = range(laser, 0.01 * (shot + share(k)) * turn) + behind;
            const auto units = static_cast<std::uint16_t>(std::lround(metres / 0.002));
            std::memcpy(&bytes[4 + 3 * static_cast<std::size_t>(k)], &units, 2);
            bytes[6 + 3 * static_cast<std::size_t>(k)] = static_cast<std::uint8_t>(8 * k);
        }
        return bytes;
    }
};

inline Spinner vlp16() { return {VelodyneCalibration::LoadDefaultCalibration("VLP16"), 40}; }
inline Spinner hdl32() { return {VelodyneCalibration::LoadDefaultCalibration("HDL32"), 15}; }

/** Lasers with offsets and corrections as an HDL-64E has them; angles in `unit` radians. */
inline Spinner hdl64(double unit) {
    Spinner spinner;
    spinner.turn = 24;
    spinner.angleUnit = unit;
    for (int i = 0; i < 64; ++i) {
        VelodyneCalibration::PerLaserCalib laser;
        const double elevation = (2 - 0.41 * i) * M_PI / 180;
        laser.verticalCorrection = elevation / unit;
        laser.sinVertCorrection = std::sin(elevation);
        laser.cosVertCorrection = std::cos(elevation);
        laser.azimuthCorrection = (i % 4 * 2.5 - 4) * M_PI / 180 / unit;
        laser.horizontalOffsetCorrection = i % 2 ? 0.026 : -0.026;
        laser.verticalOffsetCorrection = 0.2;
        spinner.calibration.laser_corrections.push_back(laser);
    }
    return spinner;
}

/** Points that are farther than 2 mm (the unit of ranges) from every wall. */
inline std::size_t offTheWalls(const Scan& scan) {
    std::size_t off = 0;
    for (std::size_t i = 0; i < scan.points->size(); ++i) {
        float x = 0, y = 0, z = 0;
        scan.points->getPoint(i, x, y, z);
        off += distanceFromWalls(x, y) > 0.002;
    }
    return off;
}

inline std::string faultOf(const mrpt::obs::CObservation& observation) {
    try {
        io::decodeObservation(observation);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}
}  // namespace delio::spinner_test
