#pragma once

#include <memory>
#include "delio/odometry/scan.h"

#include "delio/core/odometry_options.h"
#include "delio/odometry/step.h"

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

/** The odometry that the options choose. Throws Error where two of its options contradict each
 *  other. */
std::unique_ptr<Odometry> makeOdometry(const OdometryOptions& options);
}  // namespace delio
