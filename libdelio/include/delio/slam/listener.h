#pragma once
#include <cstddef>

#include "delio/odometry/step.h"
#include "delio/scan/scan.h"

namespace delio {
/** How many poses an object keeps that follows a drive: those of all scans, or only what the next
 *  scan needs, so that its size does not grow with the drive. */
enum class History { All, Last };

/** One scan as Slam tells its listeners of it; what it refers to lives as long as the call. */
struct SlamScan {
    std::size_t node;  //!< number of its pose, from 0
    const Scan& scan;  //!< as it came
    const Step& step;  //!< what the odometry said of it
    /** Of the vehicle, since the scan before; identity for the first. */
    Increment increment;
    /** Of the vehicle, by the odometry alone: maps its coordinates to those it had at the first
     *  scan. */
    Eigen::Isometry3d pose;
};

/** What stands still of a scan, in the vehicle's frame: a part of the points, which many scans
 *  together make up for. */
Eigen::Matrix3Xf stillPoints(const SlamScan& scan);

/** What is done with an odometry's steps: a pose graph, a map, a window. */
class SlamListener {
 public:
    virtual ~SlamListener() = default;

    /** Name of its time in scans.csv, and of the listener in messages. */
    virtual const char* name() const = 0;

    /** Takes the next scan. A listener that throws gets no more scans (ScanReport::failed). */
    virtual void add(const SlamScan& scan) = 0;
};
}  // namespace delio
