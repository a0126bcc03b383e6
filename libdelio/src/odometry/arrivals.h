#pragma once
#include <cstdint>
#include <string>
#include "delio/core/odometry_options.h"

#include "core/timeline.h"
#include "delio/odometry/scan.h"
#include "odometry/motion_model.h"
#include "odometry/preprocess.h"

namespace delio::odometry {
/** What a scan's stamp and points say before the scan is registered. */
struct Arrival {
    Interval interval;    //!< since the scan before
    unsigned copies = 0;  //!< scans in a row, up to this one, with the points of the one before
    /** Scans in a row, up to this one, whose points have no times while those before had. */
    unsigned untimed = 0;
};

/** Recognises scans that are no new measurement: drivers repeat scans, and recorders merge topics.
 */
class Arrivals {
 public:
    /** `needTimes`: scans are de-skewed by the times of their points. */
    explicit Arrivals(bool needTimes) : needTimes_(needTimes) {}

    /** Takes the next scan, which was measured at `time_s`: seconds, of the stamps' clock. */
    Arrival take(const Scan& scan, double time_s);

    /** Sum of the intervals, seconds: rises with every scan, whatever the stamps do. */
    double sinceStart_s() const { return timeline_.sinceStart_s(); }

 private:
    bool needTimes_;
    Timeline timeline_;
    std::uint64_t fingerprint_ = 0;  //!< of the latest scan's points
    unsigned copies_ = 0, untimed_ = 0;
    bool hadTimes_ = false;  //!< points of a scan had times
};

/** True where scans are de-skewed by the times that their source gives. */
inline bool needsTimes(const PreprocessOptions& options) {
    return options.deskew && options.sweep_s == 0;
}

/** Why a scan says nothing about the motion since the one before; empty where it does.
 *  - It came much sooner than usual. The noise of its registration, divided by so short a time,
 *    is no speed.
 *  - It repeats the points of the scan before while the sensor is predicted to move. Such a scan
 *    registers perfectly at the pose of the one before and would stop the motion model. (A second
 *    copy, while no motion is known, counts as a sensor at rest.)
 *  - Its points have lost their times, so that it cannot be de-skewed as the scans before were.
 *    From the fourth such scan in a row on, scans are taken as they come. */
std::string reasonToSkip(const Arrival& arrival, const LinearPrediction& prediction);
}  // namespace delio::odometry
