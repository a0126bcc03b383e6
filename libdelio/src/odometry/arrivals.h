#pragma once
#include <cstdint>
#include <optional>
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
    double time_s = 0;    //!< when the scan was measured, seconds, of the stamps' clock
    unsigned copies = 0;  //!< scans in a row, up to this one, with the points of the one before
    /** Scans in a row, up to this one, whose points have no times while those before had. */
    unsigned untimed = 0;
};

/** Evens stamps out that jitter against the times of the points, as stamps of arrival do: the turns
 *  of a spinning LiDAR follow each other without a gap, and each takes as long as the points say.
 */
class TurnClock {
 public:
    /** What has to be added to the scan's stamp, seconds. 0 until an interval differs from the
     *  duration of a turn by more than 5 %. */
    double correction_s(const Scan& scan);

 private:
    bool isUneven(const Scan& scan, double interval_s);
    double follow(double stamp_s, double interval_s);

    enum class State { kOff, kNoStamp, kRaw, kEvened };
    State state_ = State::kNoStamp;
    double raw_s_ = 0, even_s_ = 0;   //!< the latest stamp, as it came and evened out
    std::optional<double> period_s_;  //!< of a turn, once it was asked for; 0: nothing spins
};

/** Recognises scans that are no new measurement: drivers repeat scans, and recorders merge topics.
 */
class Arrivals {
 public:
    /** `needTimes`: scans are de-skewed by the times of their points. */
    explicit Arrivals(bool needTimes) : needTimes_(needTimes) {}

    /** Takes the next scan, which was measured at `time_s` by its stamp: seconds, of the stamps'
     *  clock. */
    Arrival take(const Scan& scan, double time_s);

    /** Sum of the intervals, seconds: rises with every scan, whatever the stamps do. */
    double sinceStart_s() const { return timeline_.sinceStart_s(); }

 private:
    bool needTimes_;
    TurnClock clock_;
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
