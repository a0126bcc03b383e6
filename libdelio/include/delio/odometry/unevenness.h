#pragma once
#include <Eigen/Geometry>
#include <deque>

#include "delio/planes/course_registration.h"

namespace delio {
/** How uneven the sensor's motion is: how far it was off constant speed lately, from one scan to
 * the next. A vehicle on a road 0.1 deg, what a hand swings 10. */
class Unevenness {
 public:
    /** What an increment turned out to be beside what it would have been at constant speed. */
    void observe(const Eigen::Isometry3d& found, const Eigen::Isometry3d& even);

    /** Root mean square of the latest along (no more than `most` metres) and about each axis; while
     *  little is known, it may be anything that a hand does. */
    planes::CoursePrior prior(double most) const;

 private:
    std::deque<double> squares_m2_, squares_rad2_;  //!< an axis
};
}  // namespace delio
