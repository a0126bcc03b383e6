#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "findings.h"

namespace delio::io {
/** The times of a scan's points as the recorder wrote them. */
struct RecordedTimes {
    std::vector<double> values;    //!< of each point, in a unit of the recorder's; NaN: none
    std::vector<bool> isMeasured;  //!< of each point: it has coordinates
    bool is32Bit = false;          //!< unsigned numbers of 32 bits, which wrap around
    double stamp_s = 0;            //!< of the scan
    std::size_t scan = 0;          //!< its index
};

/** Finds the unit of point times (s, ms, us, ns) and what they count from (the stamp of the scan,
 *  its first point, or 1970) from the first scans of a drive, and again where three scans in a row
 *  contradict it. It goes by the quantiles of the times of points that have coordinates. One a
 *  drive. */
class PointClock {
 public:
    /** Looks at one of the first scans; several show more than one. False: enough were seen. */
    bool look(RecordedTimes times);

    /** Time of each point in seconds from the stamp; NaN where it has none or an impossible one.
     *  Empty where the scan has no times: all zero, or they do not fit the clock. */
    std::vector<float> secondsOf(RecordedTimes times);

    /** Ignored or corrected data, one line per kind. */
    std::vector<std::string> findings() const { return findings_.lines(); }

 private:
    /** Range of nearly all times of a scan, in its unit. */
    struct Range {
        double first = 0, last = 0;
        std::size_t count = 0;  //!< of times
        double stamp_s = 0;
    };
    enum class Zero { kStamp, kFirstPoint, kUnix };
    struct Clock {
        double unit_s = 1;
        Zero zero = Zero::kStamp;
        bool operator==(const Clock& other) const {
            return unit_s == other.unit_s && zero == other.zero;
        }
    };

    static std::optional<Range> rangeOf(const RecordedTimes& times);
    static Clock clockOf(const std::vector<Range>& scans);
    static Zero zeroOf(const std::vector<Range>& scans, double unit_s);
    static bool fits(const Clock& clock, const Range& range);
    std::size_t unwrap(RecordedTimes& times) const;
    bool accepts(const Range& range, std::size_t scan);
    void watch(double first, const Range& range, std::size_t scan);

    std::vector<Range> seen_;  //!< of the first scans
    std::optional<Clock> clock_, other_;
    bool goesOn_ = false;             //!< times go on from scan to scan, from the drive's begin
    std::size_t contradictions_ = 0;  //!< scans in a row that fit `other_` only
    struct Passed {
        double first_s, stamp_s, usual_s;
    };
    std::optional<Passed> latest_;
    Findings findings_;
};
}  // namespace delio::io
