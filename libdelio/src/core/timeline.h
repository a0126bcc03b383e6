#pragma once
#include <deque>

namespace delio {
/** How the time between two scans compares with the usual one. */
enum class IntervalKind {
    kUsual,   //!< one turn of the sensor, or a few
    kShort,   //!< less than a fifth of the usual one: no turn of the sensor lies in between
    kUnknown  //!< a pause, or a clock that was set: the motion in between is not known
};

/** The time between a scan and the one before it. */
struct Interval {
    IntervalKind kind = IntervalKind::kUsual;  //!< how the time compares with the usual one
    double duration_s = 0;  //!< more than 0; the usual one where the kind is kUnknown
    double elapsed_s = 0;   //!< by the stamps where the kind is kUnknown, otherwise the duration
};

/** The only reader of stamps. Turns them into the durations between scans. */
class Timeline {
 public:
    /** Takes the stamp (seconds) of the next scan. For the first scan, or if stamps do not
     *  increase, the duration is the usual one. The interval is unknown if stamps differ by more
     *  than a second and more than five times the usual interval, in either direction. A copy of
     *  the scan before, with a stamp that does not increase, was sent twice: the interval is short.
     */
    Interval advance(double stamp_s, bool isCopy = false);

    /** Sum of the durations: rises with every scan, whatever the stamps do. */
    double sinceStart_s() const { return sinceStart_s_; }

 private:
    double usual_s() const;

    bool started_ = false;
    double stamp_s_ = 0, sinceStart_s_ = 0;
    std::deque<double> latest_s_;  //!< the latest intervals that are not unknown
};
}  // namespace delio
