#pragma once
#include <deque>

namespace delio {
/** The time between a scan and the one before it. */
struct Interval {
    double duration_s = 0;  //!< more than 0
    /** False after a pause, or where a clock was set: `duration_s` is the usual one then, and the
     *  motion in between is not known. */
    bool believed = true;
    /** What the stamps say, where that is not believed: the motion in between may have taken so
     *  long; else the duration. */
    double elapsed_s = 0;
};

/** The only reader of stamps: what durations are believed between scans. */
class Timeline {
 public:
    /** Takes the stamp (seconds) of the next scan. Where there is none before it, or stamps do not
     *  rise, the interval is what is usual; likewise, and not believed, where the stamps are more
     *  than a second and more than five times the usual interval apart, forwards or backwards. */
    Interval advance(double stamp_s);

    /** Sum of the durations: rises with every scan, whatever the stamps do. */
    double sinceStart_s() const { return sinceStart_s_; }

    /** What has to be kept to go on later: see core/checkpoint.h. */
    template <class Archive>
    void serialize(Archive& archive) {
        archive(started_, stamp_s_, sinceStart_s_, latest_s_);
    }

 private:
    double usual_s() const;

    bool started_ = false;
    double stamp_s_ = 0, sinceStart_s_ = 0;
    std::deque<double> latest_s_;  //!< intervals that were believed
};
}  // namespace delio
