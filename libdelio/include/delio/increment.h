#pragma once
#include <mrpt/math/CMatrixFixed.h>
#include <mrpt/poses/CPose3D.h>

namespace delio {
/** A relative pose with its uncertainty. `pose` maps the coordinates of the later frame to those
 *  of the earlier one (p_earlier = pose * p_later; chained: T_later = T_earlier + pose). */
struct Increment {
    mrpt::poses::CPose3D pose;

    /** Order [x y z wx wy wz], metres and radians, of the error e in
     *  pose_true = pose * (exp(w), t): the right tangent, expressed in the later frame. */
    mrpt::math::CMatrixDouble66 covariance = mrpt::math::CMatrixDouble66::Identity();
};
}  // namespace delio
