#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <deque>
#include <vector>

#include "delio/odometry/step.h"
#include "odometry/moving_scan.h"

namespace delio::odometry {
/** A scan at its stamp. */
struct Stamped {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< sensor to map
    double stamp_s = 0;                                      //!< from the scan's time
    double time_s = 0;                                       //!< of the scan, since the start

    double sinceStart_s() const { return time_s + stamp_s; }
};

/** One place of the sensor in two frames: the map, and the path that was reported. */
struct Anchor {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();      //!< sensor to map
    Eigen::Isometry3d reported = Eigen::Isometry3d::Identity();  //!< sensor to first stamp
};

/** The sensor's path from stamp to stamp as the steps reported it, and the latest scans in it,
 *  which later scans may correct. A step leads from the pose that was reported for the scan before
 *  to the pose of this scan in the map. Where the map moves below the reported path, moveTo() says
 *  how both lie to each other. */
class ReportedPath {
 public:
    /** An earlier scan. */
    struct Scan {
        double time_s = 0;          //!< of the scan, since the start
        double stamp_s = 0;         //!< its stamp, likewise
        Anchor at;                  //!< at the stamp
        bool isCorrected = false;   //!< by the latest scan
        bool isRegistered = false;  //!< at the pose that the latest scan corrects
        bool staysInPlace = false;  //!< it is corrected at its stamp alone
    };

    const Stamped& latest() const { return latest_; }
    Anchor anchor() const { return {latest_.pose, reported_}; }

    /** The next step leads from where the path is once `anchor` lies at its pose in the map. */
    void moveTo(const Anchor& anchor) {
        latest_.pose = anchor.pose * anchor.reported.inverse() * reported_;
    }

    /** Takes the latest scan. The step to it, from `before`: pose of the scan before at its stamp,
     *  sensor to map. */
    Eigen::Isometry3d advance(const Stamped& latest, const Eigen::Isometry3d& before);

    /** The scans, oldest first; the latest one comes in with report(). */
    std::deque<Scan>& scans() { return scans_; }

    /** Corrects the scan before the latest one at its stamp: the latest one shows where the sensor
     *  was then (sensor to map). */
    void correctStamp(const Eigen::Isometry3d& pose);

    /** Corrects the scans since the stamp `from_s`, which lie on `trajectory` (sensor to map, since
     *  the start). */
    void correctSince(double from_s, const ScanTrajectory& trajectory);

    /** Corrects the scans after `lost_s`, as the map that the sensor left then is found again:
     *  those since `left_s` move by `toLeft` with the map that began there, and the motion between
     *  both was even. */
    void correctSince(double lost_s, double left_s, const Eigen::Isometry3d& toLeft);

    /** Corrects the scans among `scans`, whose trajectories changed. Returns how those before move
     *  along. */
    Eigen::Isometry3d correct(const std::vector<MovingScan>& scans);

    /** Ends the step of the latest scan: adds the corrected poses to it. */
    void report(Step& step);

 private:
    Stamped latest_;
    Eigen::Isometry3d reported_ = Eigen::Isometry3d::Identity();  //!< latest stamp to the first
    std::deque<Scan> scans_;
};
}  // namespace delio::odometry
