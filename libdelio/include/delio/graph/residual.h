#pragma once
#include <mrpt/poses/CPose3D.h>

#include <Eigen/Core>

namespace delio::graph {
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/** How far two poses are from what an edge between them measured. With Z the measured increment,
 *  E = Z^-1 T_from^-1 T_to and error = [translation of E, log of the rotation of E]: the error of
 *  delio::Increment, in its order [x y z wx wy wz], in metres and radians. */
struct Residual {
    Vector6 error;
    Matrix6 dFrom;  //!< d error / d e for T_from * (exp(w), t), e = [t w]
    Matrix6 dTo;    //!< the same for T_to * (exp(w), t)
};

Residual residualOf(const mrpt::poses::CPose3D& increment, const mrpt::poses::CPose3D& from,
                    const mrpt::poses::CPose3D& to);
}  // namespace delio::graph
