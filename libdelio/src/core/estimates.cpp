#include "core/estimates.h"

namespace delio {
Increment incrementOf(const RotationEstimate& rotation, const TranslationEstimate& translation) {
    const Eigen::Matrix3d& R = rotation.rotation;
    Increment increment;
    increment.pose = isometry(R, translation.translation);
    Matrix6& covariance = increment.covariance;
    const Eigen::Matrix3d lever = R.transpose() * translation.lever * R;
    covariance.topLeftCorner<3, 3>() = R.transpose() * translation.covariance * R +
                                       lever * rotation.covariance * lever.transpose();
    covariance.topRightCorner<3, 3>() = lever * rotation.covariance;
    covariance.bottomLeftCorner<3, 3>() = rotation.covariance * lever.transpose();
    covariance.bottomRightCorner<3, 3>() = rotation.covariance;
    return increment;
}
}  // namespace delio
