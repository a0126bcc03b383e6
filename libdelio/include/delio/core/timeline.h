#pragma once

namespace delio {
/** The only reader of stamps: what durations are believed between scans. */
class Timeline {
 public:
    /** Takes the stamp (seconds) of the next scan. Returns the seconds since the scan before; where
     *  there is none, or stamps do not rise, what is usual for a spinning LiDAR. */
    double advance(double stamp_s) {
        constexpr double kUsual_s = 0.1;
        const double elapsed_s = stamp_s - stamp_s_;
        const double duration_s = started_ && elapsed_s > 0 ? elapsed_s : kUsual_s;
        if (started_) sinceStart_s_ += duration_s;
        started_ = true;
        stamp_s_ = stamp_s;
        return duration_s;
    }

    /** Sum of the believed durations: rises with every scan, whatever the stamps do. */
    double sinceStart_s() const { return sinceStart_s_; }

 private:
    bool started_ = false;
    double stamp_s_ = 0, sinceStart_s_ = 0;
};
}  // namespace delio
