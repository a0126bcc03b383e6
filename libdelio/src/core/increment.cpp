#include "delio/core/increment.h"

namespace delio {
namespace {
/** The covariance of a right tangent, brought to another frame by `pose`. */
Matrix6 moved(const Matrix6& covariance, const Eigen::Isometry3d& pose) {
    const Matrix6 adjoint = adjointOf(pose);
    const Matrix6 result = adjoint * covariance * adjoint.transpose();
    return (result + result.transpose()) / 2;
}
}  // namespace

Increment chained(const Increment& first, const Increment& second) {
    return {first.pose * second.pose,
            moved(first.covariance, second.pose.inverse()) + second.covariance};
}

Increment ofVehicle(const Increment& ofSensor, const Eigen::Isometry3d& sensorFrom,
                    const Eigen::Isometry3d& sensorTo) {
    return {sensorFrom * ofSensor.pose * sensorTo.inverse(), moved(ofSensor.covariance, sensorTo)};
}
}  // namespace delio
