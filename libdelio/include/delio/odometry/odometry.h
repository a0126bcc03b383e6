#pragma once
#include <iosfwd>

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

    /** All that the next scans' steps depend on. Error where it cannot be written, or where this
     *  odometry cannot be kept. */
    virtual void save(std::ostream& out) const;
    /** Into an odometry that was made with the same options and has seen no scan: from there on it
     *  goes on as the one that was saved would, to the bit. Error where that is cut off, damaged,
     *  of other options or of another version; then this one is of no use. */
    virtual void restore(std::istream& in);
};
}  // namespace delio
