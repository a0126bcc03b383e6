#pragma once
#include "delio/core/geometry.h"

namespace delio::graph {
/** How far two poses are from what an edge between them measured. With Z the measured increment,
 *  E = Z^-1 T_from^-1 T_to and error = [translation of E, log of the rotation of E]: the error of
 *  delio::Increment, in its order [x y z wx wy wz], in metres and radians. */
struct Residual {
    Vector6 error;  //!< [x y z wx wy wz], metres and radians
    Matrix6 dFrom;  //!< d error / d e for T_from * (exp(w), t), e = [t w]
    Matrix6 dTo;    //!< the same for T_to * (exp(w), t)
};

/** Of the edge `increment` between nodes at `from` and `to`. */
Residual residualOf(const Eigen::Isometry3d& increment, const Eigen::Isometry3d& from,
                    const Eigen::Isometry3d& to);
}  // namespace delio::graph
