#pragma once
#include <Eigen/Core>

namespace delio::paper {
/** The tangent vector at unit vector `at` that leads to unit vector `n` along a great circle, as
 *  long as the angle between them (radians): the logarithmic map, which the paper calls the
 *  exponential. Of the antipode, which all tangents lead to, any one. */
Eigen::Vector3d sphereLog(const Eigen::Vector3d& at, const Eigen::Vector3d& n);

/** Where the great circle along `tangent` (orthogonal to `at`) arrives: sphereLog()'s inverse. */
Eigen::Vector3d sphereExp(const Eigen::Vector3d& at, const Eigen::Vector3d& tangent);

/** Unit vectors some `spacing_deg` apart over the whole sphere: rows of equal elevation, each
 *  divided into equal steps. */
Eigen::Matrix3Xd sphereGrid(double spacing_deg);
}  // namespace delio::paper
