#pragma once
#include <array>
#include <string>
#include <vector>

#include "delio/run/run_record.h"

namespace delio::run {
/** Scans of one kind in a run. */
struct Stretches {
    std::size_t scans = 0;    //!< of the kind
    std::size_t longest = 0;  //!< longest run of them
    std::size_t from = 0;     //!< first scan of the longest run
};

/** Scans of a run that were not or barely measured. The first scan does not count. */
struct Doubts {
    std::size_t pairs = 0;  //!< scans that have one before them
    Stretches predicted;    //!< not registered: the motion model's
    Stretches lost;         //!< Step::lost
    Stretches weak;         //!< registered, but an axis was not observed
    Stretches carried;      //!< of these, those whose motion along it is the wheels'
    /** Of these the scans with an open axis of the translation that is nearest to the vehicle's x,
     * y and z. */
    std::array<std::size_t, 3> weakAlong{};
    std::array<std::size_t, 3> weakAbout{};  //!< the same of the rotation
    Stretches searched;                      //!< not only from the prediction
    Stretches interrupted;                   //!< a pause or a set clock before them
    Stretches standing;  //!< the sensor stood still: no doubt, but worth knowing
};

/** Counts them. */
Doubts doubtsOf(const std::vector<RunRow>& rows);

/** Why the trajectory is not to be relied on: more than a tenth of the scans were lost, or more
 * than half were observed weakly and wheels did not carry them. Empty where it is. */
std::string whyUnreliable(const Doubts& doubts);

/** Scans of tracks that nothing links to the longest track: no registration, no loop, no stored
 * map, no GNSS fix. Their poses relative to the others are a prediction. Of a finished run. */
Stretches unlinkedOf(const RunRecord& record);

/** Why they make the trajectory unreliable: they are more than a tenth of the scans. Else empty. */
std::string whyUnreliable(const Stretches& unlinked, std::size_t scans);

/** State of a scan, as scans.csv names it: tracked, weak, predicted or lost. */
const char* stateOf(const RunRow& row);

/** "38, longest run 30 (from scan 12)"; `scans` replaces the counted number. */
std::string textOf(const Stretches& found, std::size_t scans);

/** Of the weak ones: "along x in 38, about z in 2"; empty if there is no weak scan. */
std::string weakAxesOf(const Doubts& doubts);

/** Warnings for the user; none for a few scans. */
std::vector<std::string> warningsOf(const Doubts& doubts);

/** Warnings for a drive in a stored map: scans outside it. */
std::vector<std::string> warningsOf(const std::vector<MapFix>& fixes,
                                    const std::vector<RunRow>& rows);
}  // namespace delio::run
