#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace delio::io {
/** Counts what a reader left out of scans or read in another way than it was written. */
class Findings {
 public:
    /** `what` was found in the scan with this index; `points` of its points are concerned (0: all
     *  of the scan). */
    void add(const std::string& what, std::size_t scan, std::size_t points = 0);
    /** A line for each `what`, in the order in which they were found first: "WHAT: 12 points of 3
     *  scans (first: scan 7)". */
    std::vector<std::string> lines() const;

 private:
    struct Finding {
        std::string what;
        std::size_t scans, points, first;
    };
    std::vector<Finding> all_;
};

/** How often something happened, and in which scan first. */
struct Happened {
    std::size_t count = 0, first = 0;

    void add(std::size_t times, std::size_t scan) {
        if (count == 0) first = scan;
        count += times;
    }
    /** "12 columns (first in scan 3)". */
    std::string of(const std::string& what) const {
        return std::to_string(count) + " " + what + (count == 1 ? "" : "s") + " (first in scan " +
               std::to_string(first) + ")";
    }
};

/** Warnings of both decoders. */
inline std::string interpolatedTimes(const std::string& parts) {
    return "interpolated the times of " + parts + ", which lay outside their revolution";
}
inline std::string noTimes(const std::string& turns) {
    return "no point times in " + turns + ": the sensor's times are invalid";
}
}  // namespace delio::io
