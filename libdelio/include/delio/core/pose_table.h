#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "delio/core/course.h"

namespace delio {
/** A course, for those who ask often: poses at times so close to each other that what lies between
 *  is their weighted mean. */
class PoseTable {
 public:
    /** From `first_s` to `last_s`. */
    PoseTable(const Course& course, double first_s, double last_s);

    /** As Course::at(), within 1e-6 rad where it turns by less than 0.7 rad in all. */
    Eigen::Isometry3d at(double time_s) const;

 private:
    double first_s_, perSecond_;
    std::vector<Eigen::Isometry3d> poses_;
};
}  // namespace delio
