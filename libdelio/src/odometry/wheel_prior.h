#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <deque>
#include <optional>

#include "delio/odometry/wheels.h"
#include "odometry/inertial.h"
#include "odometry/waiting_samples.h"

namespace delio::odometry {
/** The LiDAR's translation between two times by the wheels, in its axes at the earlier time. */
struct WheelStep {
    Eigen::Vector3d moved = Eigen::Vector3d::Zero();  //!< of the wheels, metres
    /** From the wheels' origin to the LiDAR, metres. */
    Eigen::Vector3d lever = Eigen::Vector3d::Zero();
    double sigma_m = 0;  //!< standard deviation along each axis

    /** With the rotation of the LiDAR meanwhile, later axes to earlier ones. */
    Eigen::Vector3d translation(const Eigen::Matrix3d& turned) const {
        return moved + turned * lever - lever;
    }
};

/** The sensor's motion by wheels or another odometry, and how far it agrees with the scans that
 *  were registered along every axis: the scale of its distances and their standard deviation. Times
 *  are seconds since the start of the drive. */
class WheelPrior {
 public:
    /** Takes a sample, which waits until a scan is as late as it. */
    void add(const OdometrySample& sample);

    /** No sample came. */
    bool isEmpty() const { return samples_ == 0 && waiting_.isEmpty(); }

    /** Uses the samples up to the scan. `sensorPose`: of the LiDAR, sensor to vehicle. */
    void advance(const ScanClock& scan, const Eigen::Isometry3d& sensorPose);

    /** The scaled motion between two times; nothing where samples are missing or jump. */
    std::optional<WheelStep> between(double from_s, double to_s) const;

    /** The motions before this time agree with the registered ones. */
    bool isTrustedAt(double time_s) const { return trusted_ && time_s > suspended_s_; }
    /** They do, or there are too few to decide. */
    bool isPossibleAt(double time_s) const {
        const bool isNew = compared_ < kFewest && contradicting_ == 0;
        return isTrustedAt(time_s) || (isNew && isScalePlausible());
    }

    /** The motion between two times as the scans were registered, along every axis. */
    void observe(double from_s, double to_s, const Eigen::Isometry3d& increment);

    /** Counts a scan after the first sample: whether its translation is the wheels'. */
    void count(double time_s, bool carried);

    /** Nothing before the first sample. */
    std::optional<OdometryReport> report() const;

 private:
    static constexpr std::size_t kFewest = 10;  //!< stretches to be trusted

    /** A sample. */
    struct Reading {
        double time_s = 0;
        Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
        unsigned run = 0;  //!< another number: the odometry jumped in between
    };
    /** Both ways over some metres, in the LiDAR's axes where they begin. */
    struct Stretch {
        double end_s = 0;
        Eigen::Vector3d lidar = Eigen::Vector3d::Zero();
        Eigen::Vector3d wheels = Eigen::Vector3d::Zero();  //!< not scaled
        Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();

        double residual_m(double scale) const { return (lidar - scale * wheels).norm(); }
        bool isOff(double scale) const;
    };

    void use(double time_s, const Eigen::Isometry3d& pose);
    std::optional<Reading> readingAt(double time_s) const;
    std::optional<WheelStep> unscaled(double from_s, double to_s) const;
    void compare();
    double scaleOfStretches() const;
    void judge();
    bool isScalePlausible() const;
    void explain(OdometryReport& report) const;

    WaitingSamples<OdometrySample> waiting_;
    std::deque<Reading> readings_;
    std::optional<Eigen::Vector3d> speed_mps_;  //!< between the latest readings
    double shift_s_ = 0;                        //!< from times of the drive to the stamps' clock
    unsigned run_ = 0;
    std::optional<Eigen::Isometry3d> framePose_;  //!< of the odometry in the vehicle
    Eigen::Isometry3d lidarPose_ = Eigen::Isometry3d::Identity();  //!< in the odometry's frame

    std::optional<Stretch> open_;
    std::deque<Stretch> stretches_;  //!< the latest ones
    double scale_ = 1;
    std::optional<double> sigma_;  //!< part of the way
    double suspended_s_ = -1;      //!< they slipped: not trusted until then
    bool trusted_ = false, wasTrusted_ = false, covered_ = false;

    std::size_t samples_ = 0, dropped_ = 0, jumps_ = 0, scans_ = 0, without_ = 0, carried_ = 0,
                distrusted_ = 0, compared_ = 0, contradicting_ = 0;
};
}  // namespace delio::odometry
