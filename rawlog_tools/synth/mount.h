#pragma once
#include <Eigen/Geometry>

#include <optional>
#include <string>

#include "scanner.h"

namespace delio::synth {
/** Orientation of the sensor frame on the vehicle. The rays are those of an upright sensor; only
 *  the frame of the points is rotated. */
struct Mount {
    double roll_deg = 0, pitch_deg = 0, yaw_deg = 0;

    bool isUpright() const { return roll_deg == 0 && pitch_deg == 0 && yaw_deg == 0; }
    /** Maps the turned sensor's coordinates to those of the upright one: yaw, then pitch (positive:
     *  the nose goes down), then roll. */
    Eigen::Isometry3d pose() const;
    /** Brings points of the upright sensor to the turned one. */
    void turn(ScanPoints& points) const;
};

/** ROLL,PITCH,YAW; nothing where `text` is anything else. */
std::optional<Mount> mountIn(const std::string& text);
}  // namespace delio::synth
