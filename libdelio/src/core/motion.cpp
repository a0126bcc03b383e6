#include "delio/core/motion.h"

namespace delio {
Motion Motion::of(const Eigen::Isometry3d& increment, double duration_s) {
    const Vector6 twist = poseLog(increment) / duration_s;
    return {twist.head<3>(), twist.tail<3>()};
}

Eigen::Isometry3d Motion::after(double time_s) const {
    Vector6 twist;
    twist << time_s * velocity, time_s * turning;
    return poseExp(twist);
}
}  // namespace delio
