#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "core/scan_trajectory.h"
#include "delio/odometry/imu.h"
#include "odometry/waiting_samples.h"

namespace delio::odometry {
/** A scan among the samples of an IMU. */
struct ScanClock {
    double time_s = 0;   //!< of the scan, seconds since the start of the drive
    double clock_s = 0;  //!< the same, of the stamps' clock
    double last_s = 0;   //!< of the scan's last point, from the scan's time
};

/** The sensor's rotation by a gyroscope, and the gyroscope's calibration by the scans that were
 *  registered: bias, rotation between LiDAR and IMU, time offset. Times are seconds since the start
 *  of the drive. Rotations map the LiDAR's axes at the later time to those at the earlier one. */
class GyroPrior {
 public:
    /** Takes a sample, which waits until a scan is as late as it. */
    void add(const ImuSample& sample);

    /** No sample came. */
    bool isEmpty() const { return samples_ == 0 && waiting_.isEmpty(); }

    /** Uses the samples up to the scan. `sensorPose`: of the LiDAR, sensor to vehicle. */
    void advance(const ScanClock& scan, const Eigen::Isometry3d& sensorPose);

    /** The rotation between two times; nothing where samples are missing, or the rotation between
     *  LiDAR and IMU is not known. */
    std::optional<Eigen::Matrix3d> rotation(double from_s, double to_s) const;

    /** A trajectory through `pose` at `time_s` with the gyroscope's rotation and a constant
     *  `velocity` (m/s, in the axes that `pose` maps to); at equal intervals from `first_s` to
     *  `last_s`, both from `time_s`, as its times are. Nothing as rotation(). */
    std::optional<ScanTrajectory> trajectory(const Eigen::Isometry3d& pose,
                                             const Eigen::Vector3d& velocity, double time_s,
                                             double first_s, double last_s) const;

    /** The latest rotations by the gyroscope agree with the registered ones. */
    bool isTrusted() const { return trusted_; }

    /** The latest scans turned enough to show whether the gyroscope agrees. False while the
     * rotation between LiDAR and IMU is not known. */
    bool hasTurned() const { return turned_; }

    /** The same gyroscope on a sensor that moves backwards through time. It learns nothing. */
    GyroPrior reversed() const;

    /** The rotation between two times as the scans were registered. */
    void observe(double from_s, double to_s, const Eigen::Matrix3d& rotation);

    /** Counts a scan after the first sample: whether the gyroscope predicted it. */
    void count(bool used);

    /** Nothing before the first sample. */
    std::optional<ImuReport> report() const;

 private:
    /** A sample. */
    struct Reading {
        double time_s = 0;  //!< by the IMU's clock
        Eigen::Vector3d rate = Eigen::Vector3d::Zero();
        /** Since the first reading, by the rates as they are. */
        Eigen::Quaterniond turned = Eigen::Quaterniond::Identity();
        unsigned stretch = 0;  //!< another number: samples are missing in between
    };
    struct Attitude {
        Eigen::Quaterniond turned;
        unsigned stretch;
    };
    /** Both rotations between two scans, as rotation vectors. */
    struct Pair {
        double from_s = 0, to_s = 0;
        Eigen::Vector3d lidar, imu;  //!< each in its own axes; the IMU's by the rates as they are
        double duration_s() const { return to_s - from_s; }
    };
    /** What fits the pairs best at a time offset. */
    struct Fit {
        Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  //!< IMU to LiDAR
        Eigen::Vector3d bias = Eigen::Vector3d::Zero();          //!< in the LiDAR's axes
        double squares = 0;                                      //!< of the registered rotations
        double information = 0;                                  //!< about the worst axis
        double cost = 0;                                         //!< robust
        double explained = 0;  //!< part of the registered rotations' squares, up to 1
        double ratio = 1;      //!< of the registered rotations to the gyroscope's
        double sigma_rad = 0;  //!< of the rotation about its worst axis
        bool mirrored = false;
        std::size_t pairs = 0;
    };

    void use(double time_s, const Eigen::Vector3d& rate);
    std::optional<Attitude> attitudeAt(double imuTime_s) const;
    std::optional<Eigen::Vector3d> turnBetween(double from_s, double to_s, double offset_s) const;
    std::vector<Pair> pairsAt(double offset_s) const;
    static Fit aligned(const std::vector<Pair>& pairs, const std::vector<double>& weights);
    Fit fitAt(double offset_s) const;
    double costAt(double offset_s) const;
    double bestOffset() const;
    void calibrate();
    void adopt(double offset_s);
    void takeMount();
    void estimateBias();
    Eigen::Vector3d residualOf(const Pair& pair) const;
    void judge();
    bool showsEnoughMotion() const;
    void explain(ImuReport& report) const;

    WaitingSamples<ImuSample> waiting_;
    bool isReversed_ = false;  //!< callers count time backwards
    std::deque<Reading> readings_;
    std::deque<Pair> pairs_;
    double usual_s_ = 0;  //!< between samples
    double shift_s_ = 0;  //!< from times of the drive to the stamps' clock
    unsigned stretch_ = 0, same_ = 0;
    bool frozen_ = false;

    std::optional<Eigen::Matrix3d> imuPose_;  //!< IMU to vehicle, as the source says
    std::optional<Eigen::Matrix3d> given_;    //!< IMU to LiDAR, as the source says
    std::optional<Fit> calibrated_;
    std::optional<double> offsetSigma_s_;
    std::optional<Eigen::Matrix3d> mount_;  //!< IMU to LiDAR, as it is used
    double offset_s_ = 0;
    Eigen::Vector3d bias_ = Eigen::Vector3d::Zero();  //!< in the IMU's axes
    double residual_rad_ = 0;
    bool trusted_ = false, turned_ = false;

    std::size_t sinceCalibration_ = 0;
    std::size_t samples_ = 0, dropped_ = 0, scans_ = 0, used_ = 0, without_ = 0, distrusted_ = 0;
    double frozen_s_ = 0;
    bool wasTrusted_ = false, covered_ = false;
    double lidarTurned_rad_ = 0, imuTurned_rad_ = 0;  //!< sums of angles, of all pairs
    bool mirrored_ = false;
};
}  // namespace delio::odometry
