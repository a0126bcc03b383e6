#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "core/scan_trajectory.h"
#include "delio/core/odometry_options.h"
#include "odometry/deskew.h"
#include "odometry/local_map.h"
#include "odometry/motion_model.h"
#include "odometry/plane_map.h"
#include "odometry/register_planes.h"
#include "odometry/tuning.h"

namespace delio::odometry {
/** Pose at a time that may lie outside the scan: there the motion goes on at its mean twist, as a
 *  bent motion cannot be extrapolated. */
Eigen::Isometry3d atStamp(const ScanTrajectory& motion, double stamp_s);

/** Points as a moving sensor saw them, one after the other. */
struct TimedPoints {
    Eigen::Matrix3Xd points;      //!< metres, sensor's frame at each point's own time
    std::vector<double> times_s;  //!< of each point, from the scan's time
};

/** The motion (sensor to map) during a scan, from the planes that its points lie on, each at its
 *  own time: continuous-time registration. `trajectory` is where it begins: `since_s` before the
 * scan's time the pose is known and stays; from there on it is bent by a polynomial of third
 * degree, from correspondences that are made anew while the kernel narrows from `kernel` (metres)
 * to last_kernel. Planes and prior are fused by their information. With too few points on planes it
 *  stays as it is. */
ScanTrajectory registerTrajectory(const PlaneMap& map, const TimedPoints& scan,
                                  const ScanTrajectory& trajectory, double since_s,
                                  const TrajectoryPrior& prior, double kernel,
                                  const PlaneRegistrationOptions& options);

/** A scan that was undistorted by a motion (from its own frame, times from its own), and placed. */
struct PlacedScan {
    PointEstimate estimate;
    ScanTrajectory motion;
};

/** What is known of the motion during a scan whose points have times. */
struct KnownEnds {
    Eigen::Isometry3d reference;  //!< `since_s` before the scan's time, sensor to map
    double since_s = 0;           //!< more than 0
    Eigen::Isometry3d pose;       //!< at the scan's time, likewise
    Eigen::Matrix3f upright = Eigen::Matrix3f::Identity();  //!< turns the sensor's z up
    bool byStanding = false;           //!< points above the ground place the scan
    bool isNearPrediction = false;     //!< by which the scan was de-skewed first
    Motion motion = Motion::kUnknown;  //!< before `reference`
    /** By points. Nothing where planes have to begin where points place the undistorted scan. */
    std::optional<PlacedScan> placed;
};

/** The points of these columns. */
TimedPoints timedPoints(const PointCloud& cloud, const std::vector<Eigen::Index>& columns);

/** At most `most` of the points, evenly over their order. */
TimedPoints sampled(const TimedPoints& all, Eigen::Index most);

/** At one twist from the one pose to the other and on, until the last point of `cloud`. Sensor to
 *  map, times from the scan's. */
ScanTrajectory constantTwist(const KnownEnds& known, const PointCloud& cloud);

/** `start`, bent as far as it is known to be uneven, such that the static points of `view` lie on
 *  the planes of `map`. `kernel` (metres): how far they may be off. */
ScanTrajectory refinedTrajectory(const PlaneMap& map, const ScanTrajectory& start, double since_s,
                                 const PointCloud& cloud, const ScanView& view,
                                 const Unevenness& unevenness, double kernel,
                                 const ScaledOptions& options);

/** A scan as it was seen on a trajectory, and where it is then. */
struct ScanOnTrajectory {
    ScanView view;              //!< thinned, too
    PlaneEstimate estimate;     //!< of its pose at the scan's time
    ScanTrajectory trajectory;  //!< sensor to map, times from the scan's
    double inlierRatio = 0;     //!< of its points on those of the map
};

/** Undistorts `cloud`, what is dynamic in `view` left out, and registers it as a whole. None where
 *  it is not found in the map. */
std::optional<ScanOnTrajectory> registerAlong(const ScanTrajectory& trajectory,
                                              const KnownEnds& known, const LocalMap& map,
                                              const PointCloud& cloud, const ScanView& view,
                                              const ScaledOptions& options);

/** How the sensor moved when a scan ended, and moves on. */
class Extrapolation {
 public:
    Extrapolation() = default;
    /** At constant twist, by `increment` in `duration_s` (more than 0) from the scan's time on. */
    Extrapolation(const Eigen::Isometry3d& increment, double duration_s)
        : end_s_(duration_s), end_(increment), motion_(Twist::of(increment, duration_s)) {}
    /** `trajectory`: during the scan, times and frame those of its time. The motion is that of its
     * last `over_s`. */
    Extrapolation(const ScanTrajectory& trajectory, double over_s);

    /** The sensor at `time_s` from the scan's time: maps its frame then to the one at that time. */
    Eigen::Isometry3d at(double time_s) const { return end_ * motion_.after(time_s - end_s_); }
    /** Its twist. */
    const Twist& motion() const { return motion_; }

 private:
    double end_s_ = 0;
    Eigen::Isometry3d end_ = Eigen::Isometry3d::Identity();
    Twist motion_;
};
}  // namespace delio::odometry
