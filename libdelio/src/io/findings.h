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
}  // namespace delio::io
