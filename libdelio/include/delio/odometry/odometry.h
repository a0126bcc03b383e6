#pragma once
#include "delio/odometry/step.h"
#include "delio/scan/scan.h"

namespace delio {
/** LiDAR odometry, one scan after the other, rotation and translation decoupled. See
 * makeOdometry(). */
class Odometry {
 public:
    virtual ~Odometry() = default;

    /** Registers the next scan of the drive. A scan that cannot be registered (empty, too few
     *  surfaces) gives the prediction, and says so. */
    virtual Step process(const Scan& scan) = 0;
};
}  // namespace delio
