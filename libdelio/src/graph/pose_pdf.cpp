#include "delio/graph/pose_pdf.h"

#include <Eigen/Cholesky>

#include "graph/residual.h"

namespace delio::graph {
mrpt::poses::CPose3DPDFGaussian posePdfOf(const Increment& increment) {
    const auto inverseOf = [](const Matrix6& m) {
        const Matrix6 inverse = m.ldlt().solve(Matrix6::Identity());
        return Matrix6((inverse + inverse.transpose()) / 2);
    };
    mrpt::poses::CPose3DPDFGaussian pdf(toMrpt(increment.pose));
    pdf.cov.asEigen() =
        inverseOf(convertInformation(inverseOf(increment.covariance), increment.pose,
                                     InformationOf::tangent, InformationOf::yawPitchRoll));
    return pdf;
}
}  // namespace delio::graph
