#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "delio/core/geometry.h"

namespace delio {
/** A motion at constant speed and rate of turn, both in the moving frame: a twist. */
struct Twist {
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  //!< m/s
    Eigen::Vector3d turning = Eigen::Vector3d::Zero();   //!< rad/s, a rotation vector

    /** The one that leads to `increment` in `duration_s` (more than 0). (MRPT's Lie::SE<3> leaves
     *  the translation as it is: half of its logarithm is not half the way.) */
    static Twist of(const Eigen::Isometry3d& increment, double duration_s);

    /** Pose after `time_s`: maps the frame then to the frame at the start. */
    Eigen::Isometry3d after(double time_s) const;
};

/** A motion through known poses, at constant twist from each to the next, and on beyond them. */
class ScanTrajectory {
 public:
    /** `times_s`: at least two, which increase. `poses`: one for each time; they map the moving
     * frame to a frame at rest. Throws Error where this does not hold. */
    ScanTrajectory(const std::vector<double>& times_s, const std::vector<Eigen::Isometry3d>& poses);

    /** Through the identity at time 0, always at the same twist. */
    ScanTrajectory(const Twist& motion);  // NOLINT(google-explicit-constructor): each motion is one

    /** At the times given, through `pose` at the first of them, always at the same twist. */
    static ScanTrajectory even(const std::vector<double>& times_s, const Eigen::Isometry3d& pose,
                               const Twist& motion);

    /** Maps the moving frame at `time_s` to the one that rests. */
    Eigen::Isometry3d at(double time_s) const;
    /** The trajectory relative to its pose at `time_s`, with times from then. */
    ScanTrajectory seenFrom(double time_s) const;

    /** Of the poses. */
    const std::vector<double>& times_s() const { return times_s_; }
    /** At these times. */
    const std::vector<Eigen::Isometry3d>& poses() const { return poses_; }

 private:
    std::vector<double> times_s_;
    std::vector<Eigen::Isometry3d> poses_;
    std::vector<Twist> motions_;  //!< on from each pose but the last
};

/** The trajectory in a frame in which its own frame at rest has this pose. */
ScanTrajectory placed(const Eigen::Isometry3d& pose, const ScanTrajectory& trajectory);

/** A trajectory for many lookups: poses at times so close to each other that a pose in between is
 * their weighted mean. */
class PoseTable {
 public:
    /** From `first_s` to `last_s`. */
    PoseTable(const ScanTrajectory& trajectory, double first_s, double last_s);

    /** Approximates ScanTrajectory::at() within 1e-6 rad for rotations below 0.7 rad. */
    Eigen::Isometry3d at(double time_s) const;

 private:
    double first_s_, perSecond_;
    std::vector<Eigen::Isometry3d> poses_;
};
}  // namespace delio
