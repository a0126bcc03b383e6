#include "delio/pose_pdf.h"

#include <Eigen/Cholesky>

#include "delio/graph/information.h"

namespace delio {
mrpt::poses::CPose3DPDFGaussian posePdfOf(const Increment& increment) {
    using graph::InformationOf;
    const auto inverseOf = [](const graph::Matrix6& m) {
        const graph::Matrix6 inverse = m.ldlt().solve(graph::Matrix6::Identity());
        return graph::Matrix6((inverse + inverse.transpose()) / 2);
    };
    mrpt::poses::CPose3DPDFGaussian pdf(increment.pose);
    pdf.cov.asEigen() = inverseOf(
        graph::convertInformation(inverseOf(increment.covariance.asEigen()), increment.pose,
                                  InformationOf::tangent, InformationOf::yawPitchRoll));
    return pdf;
}
}  // namespace delio
