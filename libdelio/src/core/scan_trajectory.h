#pragma once
#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
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
 * their weighted mean. `Scalar`: float or double. */
template <typename Scalar>
class PoseTableOf {
 public:
    using Matrix = Eigen::Matrix<Scalar, 4, 4>;
    using Vector = Eigen::Matrix<Scalar, 3, 1>;
    using Isometry = Eigen::Transform<Scalar, 3, Eigen::Isometry>;

    /** From `first_s` to `last_s`. */
    PoseTableOf(const ScanTrajectory& trajectory, double first_s, double last_s);

    /** Approximates ScanTrajectory::at() within 1e-6 rad for rotations below 0.7 rad. */
    Isometry at(Scalar time_s) const {
        const auto [part, share] = partAt(time_s);
        return Isometry(Matrix(part.pose + share * part.change));
    }
    /** The place alone. */
    Vector placeAt(Scalar time_s) const {
        const auto [part, share] = partAt(time_s);
        return part.pose.template topRightCorner<3, 1>() +
               share * part.change.template topRightCorner<3, 1>();
    }

 private:
    struct Part {
        Matrix pose, change;  //!< at its start, and until its end
    };
    struct InPart {
        const Part& part;
        Scalar share;  //!< of the part that has passed
    };
    InPart partAt(Scalar time_s) const {
        const Scalar at = (time_s - first_s_) * perSecond_;
        const Scalar last = static_cast<Scalar>(parts_.size() - 1);
        const auto k = static_cast<std::size_t>(std::clamp(at, Scalar{0}, last));
        return {parts_[k], at - static_cast<Scalar>(k)};
    }

    Scalar first_s_, perSecond_;
    std::vector<Part> parts_;
};
extern template class PoseTableOf<float>;
extern template class PoseTableOf<double>;
using PoseTable = PoseTableOf<double>;
}  // namespace delio
