#pragma once
#include <cstddef>
#include <string>

namespace delio::io {
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
    return "interpolated the times of " + parts + ", which were not within their turn";
}
inline std::string noTimes(const std::string& turns) {
    return "no times for the points of " + turns + ": the sensor's times of them make no sense";
}
}  // namespace delio::io
