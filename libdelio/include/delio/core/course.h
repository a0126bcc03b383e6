#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "delio/core/motion.h"

namespace delio {
/** A motion through known poses, at constant twist from each to the next, and on beyond them. */
class Course {
 public:
    /** `times_s`: at least two, which increase. `poses`: one for each time; they map the moving
     * frame to a frame at rest. Throws Error where this does not hold. */
    Course(const std::vector<double>& times_s, const std::vector<Eigen::Isometry3d>& poses);

    /** Through the identity at time 0, always at the same twist. */
    Course(const Motion& motion);  // NOLINT(google-explicit-constructor): each motion is one

    /** At the times given, through `pose` at the first of them, always at the same twist. */
    static Course even(const std::vector<double>& times_s, const Eigen::Isometry3d& pose,
                       const Motion& motion);

    /** Maps the moving frame at `time_s` to the one that rests. */
    Eigen::Isometry3d at(double time_s) const;
    /** As seen from where it is at `time_s`, with times from then. */
    Course seenFrom(double time_s) const;

    /** Of the poses. */
    const std::vector<double>& times_s() const { return times_s_; }
    /** At these times. */
    const std::vector<Eigen::Isometry3d>& poses() const { return poses_; }

 private:
    std::vector<double> times_s_;
    std::vector<Eigen::Isometry3d> poses_;
    std::vector<Motion> motions_;  //!< on from each pose but the last
};
}  // namespace delio
