#pragma once
#include "delio/core/geometry.h"

namespace delio {
/** A relative pose with its uncertainty. `pose` maps the coordinates of the later frame to those
 *  of the earlier one (p_earlier = pose * p_later; chained: T_later = T_earlier * pose). */
struct Increment {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< later frame to earlier one, metres

    /** Order [x y z wx wy wz], metres and radians, of the error e in
     *  pose_true = pose * (exp(w), t): the right tangent, expressed in the later frame. */
    Matrix6 covariance = Matrix6::Identity();
};

/** Concatenation of two increments with independent errors. */
Increment chained(const Increment& first, const Increment& second);

/** Converts an increment of a sensor to one of its vehicle: S_from D S_to^-1, with the poses
 *  (sensor to vehicle) that the sensor had at both ends. */
Increment ofVehicle(const Increment& ofSensor, const Eigen::Isometry3d& sensorFrom,
                    const Eigen::Isometry3d& sensorTo);
}  // namespace delio
