#pragma once
#include <Eigen/Core>

namespace delio {
/** Of a scatter of points. */
struct PrincipalAxes {
    Eigen::Vector3d variances;  //!< eigenvalues, ascending
    Eigen::Matrix3d axes;       //!< their eigenvectors
};

/** Of the cubic equation one root, by Newton's steps; of what lies across its axis a square root:
 * no sine or arc of the C library, which has others for each processor.
 *  @param scatter symmetric */
PrincipalAxes principalAxes(const Eigen::Matrix3d& scatter);
}  // namespace delio
