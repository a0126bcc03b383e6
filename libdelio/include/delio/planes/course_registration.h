#pragma once
#include <Eigen/Core>
#include <vector>

#include "delio/core/course.h"
#include "delio/planes/plane_map.h"
#include "delio/planes/plane_registration.h"

namespace delio::planes {
/** Points as a moving sensor saw them, one after the other. */
struct TimedPoints {
    Eigen::Matrix3Xd points;      //!< metres, sensor's frame at each point's own time
    std::vector<double> times_s;  //!< of each point, from the scan's stamp
};

/** What is known of a motion before the planes are asked: standard deviations along (metres) and
 *  about (rad) each axis. */
struct CoursePrior {
    double translation = 0.05;        //!< of the pose at the stamp
    double rotation = 0.02;           //!< likewise
    double unevenTranslation = 0.02;  //!< how far a motion between stamps is off constant speed
    double unevenRotation = 0.05;     //!< likewise
};

/** The motion (sensor to map) during a scan, from the planes that its points lie on, each at its
 *  own time: continuous-time registration. `course` is where it begins: `since_s` before the stamp
 *  the pose is known and stays; from there on it is bent by a polynomial of third degree, from
 *  correspondences that are made anew while the kernel narrows from `kernel` (metres) to
 *  last_kernel. Planes and prior are fused by their information. With too few points on planes it
 *  stays as it is. */
Course registerCourse(const PlaneMap& map, const TimedPoints& scan, const Course& course,
                      double since_s, const CoursePrior& prior, double kernel,
                      const PlaneRegistrationOptions& options);
}  // namespace delio::planes
