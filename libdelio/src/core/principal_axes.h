#pragma once
#include <Eigen/Core>

namespace delio {
/** Of a scatter of points. */
struct PrincipalAxes {
    Eigen::Vector3d variances;  //!< eigenvalues, ascending
    Eigen::Matrix3d axes;       //!< their eigenvectors
};

/** Eigen's direct way, with one result on every processor (portable_math.h).
 *  @param scatter symmetric */
PrincipalAxes principalAxes(const Eigen::Matrix3d& scatter);
}  // namespace delio
