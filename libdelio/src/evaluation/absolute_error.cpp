#include "delio/evaluation/absolute_error.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

namespace delio::evaluation {
namespace {
Eigen::Matrix3Xd positions(const std::vector<Eigen::Isometry3d>& poses) {
    Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(poses.size()));
    for (std::size_t i = 0; i < poses.size(); ++i)
        result.col(static_cast<Eigen::Index>(i)) = poses[i].translation();
    return result;
}
}  // namespace

AbsoluteError absoluteError(const std::vector<Eigen::Isometry3d>& reference,
                            const std::vector<Eigen::Isometry3d>& estimate) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    if (reference.empty()) return {none, none};
    const Eigen::Matrix3Xd wanted = positions(reference);
    const Eigen::Matrix3Xd found = positions(estimate);
    const Eigen::Isometry3d align(Eigen::umeyama(found, wanted, false));
    const Eigen::RowVectorXd squares = (align * found - wanted).colwise().squaredNorm();
    return {std::sqrt(squares.mean()), std::sqrt(squares.maxCoeff())};
}
}  // namespace delio::evaluation
