#pragma once
#include <Eigen/Core>
#include <deque>
#include <optional>
#include <vector>

#include "delio/odometry/imu.h"
#include "odometry/waiting_samples.h"

namespace delio {
/** Specific force, integrated from one scan to the next, in the IMU's axes at the first of them. */
struct ForceBetween {
    double duration_s = 0;
    Eigen::Vector3d once = Eigen::Vector3d::Zero();   //!< over time
    Eigen::Vector3d twice = Eigen::Vector3d::Zero();  //!< that over time again
};

/** Integrates what the accelerometer of a drive's IMU measures, turned by its gyroscope. */
class SpecificForce {
 public:
    /** Ignores a sample that is not finite. */
    void add(const ImuSample& sample);

    /** The drive's next scan, at `stamp_s` of the samples' clock (time offset included). `bias`:
     *  of the gyroscope, rad/s. */
    void addScan(double stamp_s, const Eigen::Vector3d& bias);

    /** From scan i to scan i+1; nothing where samples are missing. Ends the drive. */
    std::vector<std::optional<ForceBetween>> take();

 private:
    void integrate(double from_s, double to_s);
    std::optional<ForceBetween> between(double from_s, double to_s) const;

    struct Reading {
        double time_s;
        Eigen::Vector3d rate, force;
    };
    std::optional<Reading> readingAt(double time_s) const;

    odometry::WaitingSamples<ImuSample> waiting_;
    std::deque<Reading> readings_;
    std::deque<double> scans_s_;  //!< not integrated yet; the first one is where that goes on
    Eigen::Vector3d bias_ = Eigen::Vector3d::Zero();
    std::vector<std::optional<ForceBetween>> found_;
};
}  // namespace delio
