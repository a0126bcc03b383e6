#pragma once
#include <string>
#include <vector>

#include "delio/localisation/map_tracker.h"
#include "delio/run/run_record.h"

namespace delio::run {
/** Writes localisation.csv, a row a scan: where the vehicle was in the map as it was known then
 *  (unknown, in_map, outside; x y z and quaternion in the map's frame, and the upper triangle of
 * the covariance in the order of delio::Increment), how much of the scan stands in the map, and why
 * it was not measured. Error where the file cannot be written. */
void writeLocalisationTable(const RunRows& rows, const std::vector<MapFix>& fixes,
                            const std::string& path);

/** What a reader of localisation.csv wants to know of a scan. */
struct LocalisationRow {
    std::size_t scan = 0;                       //!< its number in its recording
    Whereabouts where = Whereabouts::kUnknown;  //!< with respect to the map
    bool measured = false;                      //!< registered to the map
};

/** Throws Error with file and line where a column is missing or malformed. */
std::vector<LocalisationRow> readLocalisationTable(const std::string& path);
}  // namespace delio::run
