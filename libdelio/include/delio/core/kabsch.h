#pragma once
#include <Eigen/Core>

namespace delio {
/** argmin over rotations of sum w |n_from - R n_to|^2, given sum w n_from n_to' (Arun, Kabsch). */
Eigen::Matrix3d rotationOf(const Eigen::Matrix3d& moment);
}  // namespace delio
