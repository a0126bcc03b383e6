#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "delio/odometry/imu.h"
#include "drive.h"
#include "mount.h"

namespace delio::synth {
/** An IMU beside the LiDAR, and its errors. */
struct ImuModel {
    double rate_hz = 200;
    double rateNoise = 0;              //!< rad/s per square root of Hz
    double rateBias_radps = 0;         //!< at the start about each axis, with a random sign
    double rateWalk = 0;               //!< random walk of that, rad/s per square root of s
    double accelerationNoise = 0;      //!< m/s^2 per square root of Hz
    double accelerationBias_mps2 = 0;  //!< along each axis, with a random sign
    double offset_s = 0;               //!< its stamps are late by this
    Mount mount;                       //!< orientation on the vehicle
};

/** Names of the grades of IMUs, worst first. */
std::vector<std::string> imuGrades();
/** The errors of a grade; nothing for an unknown one. */
std::optional<ImuModel> imuOfGrade(const std::string& grade);

/** Samples of an IMU that is carried along a drive, from 0.3 s before its first scan on. */
class Imu {
 public:
    Imu(const ImuModel& model, const Drive& drive, std::uint64_t seed);

    /** The next sample, if it is stamped no later than `stamp_s`. Its pose on the vehicle is not
     *  recorded. */
    std::optional<ImuSample> next(double stamp_s);

    /** Rate, mount, offset and bias so far: the text of OUT.imu.yaml. */
    std::string truth() const;

 private:
    double timeOf(std::size_t sample) const;

    ImuModel model_;
    const Drive& drive_;
    std::uint64_t seed_;
    Eigen::Vector3d firstBias_, bias_, accelerationBias_;
    std::size_t samples_ = 0;
};
}  // namespace delio::synth
