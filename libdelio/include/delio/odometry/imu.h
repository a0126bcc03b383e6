#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace delio {
/** One measurement of an inertial measurement unit (IMU). */
struct ImuSample {
    double stamp_s = 0;  //!< seconds, of the clock of Scan::stamp_s
    /** Angular velocity, rad/s, in the IMU's frame; NaN: not measured. */
    Eigen::Vector3d rate_radps =
        Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    /** Acceleration (at rest: 9.81 upwards), m/s^2, in the IMU's frame; NaN: not measured. */
    Eigen::Vector3d acceleration_mps2 =
        Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    /** Pose of the IMU in the vehicle: maps the IMU's coordinates to the vehicle's; nothing where
     *  the source does not say it. */
    std::optional<Eigen::Isometry3d> sensorPose;
    /** Added to a scan's time, it gives the stamp of the same moment, seconds, at most 0.1; nothing
     *  where it is not known. */
    std::optional<double> offset_s = std::nullopt;
};

/** What an odometry found out about the IMU. Rotations map the IMU's axes to the LiDAR's. */
struct ImuReport {
    std::size_t samples = 0;       //!< that were used
    std::size_t dropped = 0;       //!< not finite, without a rate, or not later than the one before
    std::size_t scans = 0;         //!< that came after the first sample
    std::size_t scansUsed = 0;     //!< whose rotation the gyroscope predicted
    std::size_t scansWithout = 0;  //!< for which samples were missing
    /** Rotation that is used; nothing: it is not known, or the rates contradict the scans. */
    std::optional<Eigen::Matrix3d> rotation;
    /** Standard deviation of the calibrated rotation about its worst axis, rad; nothing: it was not
     *  calibrated, the rotation is the recording's. */
    std::optional<double> rotationSigma_rad;
    double offset_s = 0;  //!< added to a scan's time, it gives the IMU's stamp
    /** Its standard deviation, seconds; nothing: the offset is not known and taken as 0. */
    std::optional<double> offsetSigma_s;
    Eigen::Vector3d bias_radps = Eigen::Vector3d::Zero();  //!< of the rate, in the IMU's frame
    double residual_rad = 0;  //!< root mean square of the rotations' differences between two scans
    /** Why the gyroscope was not or not always used, a line each. */
    std::vector<std::string> findings;
};

/** The vertical of a drive's map, by the IMU's accelerometer. */
struct Vertical {
    Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  //!< unit vector in the map's frame
    /** Standard deviation about the worse horizontal axis, rad. A bias that the drive does not show
     *  is taken as below 0.1 m/s^2. */
    double sigma_rad = 0;
    Eigen::Vector3d bias_mps2 = Eigen::Vector3d::Zero();  //!< of the acceleration, IMU's frame
    std::size_t stretches = 0;                            //!< of four seconds, that it is made of
    bool holdsTilt = false;  //!< they hold the tilt of the poses in the pose graph
    std::string refusal;     //!< why it is not known; empty: it is
};
}  // namespace delio
