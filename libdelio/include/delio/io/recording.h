#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace delio::io {
/** What a source of scans says of itself. */
struct Recording {
    std::string kind;                       //!< e.g. "ROS 1 bag, topic /points"
    std::string sensor;                     //!< e.g. "Velodyne VLP-16"; empty: not known
    std::optional<double> rate_hz;          //!< scans a second, where two were seen
    bool startsEmpty = false;               //!< the first scans have no points
    bool pointTimes = false;                //!< points come with the times they were measured at
    std::optional<bool> motionCompensated;  //!< by the recorder; nothing: it does not say
    bool compensationMeasured = false;      //!< from the points: the source does not say it
    bool compensationAssumed = false;       //!< because most recordings of that kind are so
    /** A scan whose points tell that they were de-skewed, although the first ones, of a vehicle
     *  that stood, did not. */
    std::optional<std::size_t> compensatedAfterAll;
    std::optional<std::size_t> scans;   //!< where they are counted without reading them
    std::vector<std::string> warnings;  //!< what is missing but not needed
    /** What the reader left out, or took in another way than it was written, a line each with how
     *  often: complete when the last scan was read. */
    std::vector<std::string> findings;
};

/** In one line: "Velodyne VLP-16, 10 Hz, points with times, not de-skewed by the recorder, 3213
 *  scans (pcap)". */
std::string describe(const Recording& recording);
}  // namespace delio::io
