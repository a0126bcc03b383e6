#pragma once
#include "delio/core/geometry.h"

namespace delio {
/** A motion at constant speed and rate of turn, both in the moving frame: a twist. */
struct Motion {
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  //!< m/s
    Eigen::Vector3d turning = Eigen::Vector3d::Zero();   //!< rad/s, a rotation vector

    /** The one that leads to `increment` in `duration_s` (more than 0). (MRPT's Lie::SE<3> leaves
     *  the translation as it is: half of its logarithm is not half the way.) */
    static Motion of(const Eigen::Isometry3d& increment, double duration_s);

    /** Where it leads to in `time_s`: maps the frame then to the frame at the start. */
    Eigen::Isometry3d after(double time_s) const;
};
}  // namespace delio
