#pragma once
#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "delio/odometry/scan.h"
#include "findings.h"

namespace delio::io {
/** Returns scans with increasing stamps. Swapped scans are sorted. A scan whose stamp does not
 *  increase is ignored. Where none of the next scans rises, the clock was set back or stands:
 *  stamps count on from the scan before. One a drive. */
class StampOrder {
 public:
    /** How many scans take() compares. */
    static constexpr std::size_t kWindow = 3;

    /** `startsInOrder`: the first scans come in the order in which they were taken. */
    explicit StampOrder(bool startsInOrder = false) : startsInOrder_(startsInOrder) {}

    /** Takes a scan off `ahead`, the next scans as they were recorded: at least one, and kWindow
     *  unless the drive ends before. Nothing: that scan is left out. */
    std::optional<Scan> take(std::deque<Scan>& ahead);

    /** True where take() gives the first scan whatever comes after it: it follows the one before at
     *  the usual interval, or the drive starts in order. */
    bool isNext(const Scan& first) const;

    /** Ignored or changed scans, one line per kind. */
    std::vector<std::string> findings() const { return findings_.lines(); }

 private:
    /** The usual interval is not known. The first one of a sensor may be too short: its first scan
     *  can be a part of a turn. */
    bool isStart() const { return intervals_ < (startsInOrder_ ? 2U : 1U); }
    double stampOf(const Scan& scan) const { return scan.stamp_s + added_s_; }
    bool isLate(const Scan& scan) const { return latest_s_ && !(stampOf(scan) > *latest_s_); }
    bool isClockSet(const std::deque<Scan>& ahead) const;
    std::size_t earliestOf(const std::deque<Scan>& ahead) const;
    bool isOutOfOrder(const std::deque<Scan>& ahead, double gained_s) const;
    void learn(double passed_s);
    Scan give(std::deque<Scan>& ahead, std::size_t place);

    bool startsInOrder_;
    std::optional<double> latest_s_;  //!< stamp of the scan that was given last
    double usual_s_ = 0;              //!< from one scan to the next; 0: not known
    unsigned intervals_ = 0;          //!< that were learnt from
    double added_s_ = 0;              //!< to the stamps that were recorded
    bool wasSet_ = false;  //!< the scan before came with a clock that was set back or stopped
    std::size_t passedOver_ = 0;  //!< how often the first of `ahead` was
    Findings findings_;
};
}  // namespace delio::io
