#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <deque>
#include <vector>

#include "core/scan_trajectory.h"
#include "odometry/preprocess.h"
#include "odometry/register_trajectory.h"

namespace delio::odometry {
/** A scan whose points have their own times: metres, the sensor's frame at that time; seconds
 *  since the start of the drive. */
struct TimedScan {
    PointCloud cloud;                //!< as it came; its times count from `time_s`
    double time_s = 0;               //!< of the scan
    TimedPoints points;              //!< thinned
    TimedPoints surfaces;            //!< points on surfaces
    Eigen::Matrix3Xd normals;        //!< of these, unit vectors
    double first_s = 0, last_s = 0;  //!< times of the earliest and the latest point
};

/** `time_s`: the scan's time, seconds since the start of the drive. The points must have times. */
TimedScan timedScanOf(const PointCloud& cloud, double time_s);

/** Scans that are registered to each other. */
struct Together {
    ScanTrajectory trajectory{Twist{}};  //!< of the sensor, seconds since the start of the drive
    /** Of the latest scan's points on the surfaces of the other scans, and of theirs on its. */
    double inlierRatio = 0;
};

/** Finds the trajectory on which scans fit each other: continuous-time registration of all points
 *  to the surfaces of all other scans, each point and each surface at its own time. No map is
 *  needed, and no scan has to be free of skew. Gauss-Newton steps with new correspondences while
 *  the kernel narrows from `kernel` (metres).
 *  @param start an initial guess, at equal intervals of time; its first pose is kept
 *  @return poses at the times of `start` */
Together registerTogether(const std::deque<TimedScan>& scans, const ScanTrajectory& start,
                          double kernel);

/** How a sensor may go on turning. */
struct TurningOn {
    double acceleration = 0;  //!< this part of its acceleration goes on, 0 to 1
    Eigen::Vector3d more = Eigen::Vector3d::Zero();  //!< added to its rate of turn, rad/s
};

/** The latest scans of a sensor whose rate of turn changes faster than it can be predicted, as in a
 *  swinging hand, registered together. */
class ScanWindow {
 public:
    static constexpr std::size_t kMostScans = 4;

    bool isEmpty() const { return scans_.empty(); }
    bool isFull() const { return scans_.size() == kMostScans; }
    void clear() { scans_.clear(); }
    /** The window holds this scan alone, which was taken on `trajectory` (sensor to map, times from
     *  the scan's). */
    void begin(TimedScan scan, const ScanTrajectory& trajectory);
    /** Registers a scan together with those before it, from where their motion leads, and drops the
     *  oldest of more than four. False where far fewer points fit than before. */
    bool add(const PointCloud& cloud, double time_s);
    /** Registers the latest scan again, from many rates of turn. False where it fits no better. Not
     *  after addSecond(). */
    bool search();
    /** Adds the second scan, while the motion is unknown. The registration starts from `guess`, the
     *  twist since the first scan. If the motion found from there changes during the two scans, or
     *  `guess` is not `likely`, it starts from many rates of turn as well. False where no changing
     *  motion is found that clearly more points fit. */
    bool addSecond(const PointCloud& cloud, double time_s, const Twist& guess, bool likely);

    /** Oldest first. */
    const std::deque<TimedScan>& scans() const { return scans_; }
    /** Sensor to map, seconds since the start of the drive. */
    const ScanTrajectory& trajectory() const { return trajectory_; }
    /** Moves the trajectory such that the latest scan is at `pose` (sensor to map). */
    void moveTo(const Eigen::Isometry3d& pose);
    /** Takes an earlier trajectory() of the same scans again. */
    void use(const ScanTrajectory& trajectory) { trajectory_ = trajectory; }

 private:
    /** The best registration of the latest scan to the others, from each of these starts. */
    Together registerLatest(const std::vector<TurningOn>& turnings) const;
    void accept(const Together& found);

    std::deque<TimedScan> scans_;
    ScanTrajectory trajectory_{Twist{}};  //!< a pose every 20 ms
    ScanTrajectory known_{Twist{}};       //!< the same before the latest scan
    double inlierRatio_ = 0;              //!< of the latest registration
};
}  // namespace delio::odometry
