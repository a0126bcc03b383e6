#pragma once
#include <Eigen/Geometry>
#include <optional>

#include "odometry/register_planes.h"
#include "odometry/wheel_prior.h"

namespace delio::odometry {
/** The wheels beside the scan that is registered: they say where it is along the axes that it does
 *  not show, and learn from scans that show every axis. */
class Wheels {
 public:
    /** Takes a sample, which waits until a scan is as late as it. */
    void add(const OdometrySample& sample) { prior_.add(sample); }
    /** Nothing before the first sample. */
    std::optional<OdometryReport> report() const { return prior_.report(); }

    /** Uses the samples up to the scan; the one before was at `latest_s`. `sensorPose`: of the
     *  LiDAR, sensor to vehicle. */
    void advance(const ScanClock& scan, const Eigen::Isometry3d& sensorPose, double latest_s);

    /** They say how the sensor moved since the scan before, and agree with the scans so far. */
    bool areTrusted() const { return step_ && prior_.isTrustedAt(time_s_); }

    /** The same increment since the scan before, with the translation of the wheels where they say
     *  it. */
    Eigen::Isometry3d with(const Eigen::Isometry3d& increment) const;

    /** A scan that is not registered, predicted `from` the scan before (sensor to map): its
     *  translation is that of the wheels where they are trusted. */
    Eigen::Isometry3d carried(const Eigen::Isometry3d& from, const Eigen::Isometry3d& predicted);

    /** Along the axes that neither planes nor points show, the wheels move the estimate `from` the
     *  scan before (sensor to map). */
    void carry(const Eigen::Isometry3d& from, PlaneEstimate& estimate);

    /** The scan's translation is that of the wheels, in part at least. */
    bool haveCarried() const { return hasCarried_; }

    /** After the scan. `isObserved`: it showed every axis; `increment`: from stamp to stamp. */
    void learn(bool isObserved, double from_s, double to_s, const Eigen::Isometry3d& increment);

 private:
    WheelPrior prior_;
    double time_s_ = 0;              //!< of the scan
    std::optional<WheelStep> step_;  //!< since the scan before
    bool hasCarried_ = false;
    bool wasObserved_ = false;  //!< the scan before, along every axis
};
}  // namespace delio::odometry
