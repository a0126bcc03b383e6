#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "delio/io/trajectory.h"
#include "delio/odometry/odometry.h"
#include "delio/slam/listener.h"

namespace delio {
/** What became of one scan. */
struct ScanReport {
    Step step;
    std::vector<Named> listeners_ms;  //!< time of each listener, under its name
};

/** An odometry and its listeners: scans in, and each listener is told of every step in turn. Poses
 *  are the vehicle's: they map its coordinates to those it had at the first scan. */
class Slam {
 public:
    explicit Slam(std::unique_ptr<Odometry> odometry) : odometry_(std::move(odometry)) {}

    /** From the next scan on it is told of every scan, after those that were attached before. */
    void attach(std::shared_ptr<SlamListener> listener);

    /** Where the odometry or a listener throws, trajectory and listeners are as they were before,
     *  as if the scan had not been recorded: how far it led is counted to the next one. (Not where
     *  that is not known: the odometry threw, or gave an increment that is not finite, which is an
     *  Error.) */
    ScanReport process(const Scan& scan);

    /** Of the odometry alone. */
    const io::Trajectory& trajectory() const { return trajectory_; }

 private:
    void tell(const SlamScan& scan, ScanReport& report);

    std::unique_ptr<Odometry> odometry_;
    std::vector<std::shared_ptr<SlamListener>> listeners_;
    io::Trajectory trajectory_;
    /** Sensor in the vehicle at the last scan that was taken. */
    Eigen::Isometry3d sensorPose_ = Eigen::Isometry3d::Identity();
    /** From the last scan that was taken to the one that was refused after it, of the sensor. */
    std::optional<Increment> refused_;
};
}  // namespace delio
