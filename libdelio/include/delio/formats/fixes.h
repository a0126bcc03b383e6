#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "delio/earth/fix.h"

namespace delio::io {
/** Reads fixes from a file beside a recording. With the extension .csv: a header line with `time`
 *  (or `stamp`, `timestamp`: seconds; of Unix times also milli-, micro- or nanoseconds),
 *  `latitude`, `longitude` (degrees), and as far as they are known `height` (or `altitude`, m above
 *  the ellipsoid), `sigma_east`, `sigma_north`, `sigma_up` (m), `quality` (as in GGA), `hdop`.
 * Others are NMEA 0183: GGA, with the date of RMC or ZDA. Stamps are Unix times where the file has
 * dates or Unix times; otherwise the file's own: of NMEA seconds since midnight UTC. Throws Error,
 * which names file and line, for a malformed csv, and for NMEA without any fix. NMEA sentences with
 * a wrong checksum are skipped. */
earth::Fixes readFixes(const std::filesystem::path& file);

/** Unix times become seconds since `epoch_s` (a Unix time), where the drive counts from there;
 * other stamps stay. */
void countFrom(double epoch_s, earth::Fixes& fixes);

/** The fixes beside scans: gnss.csv or gnss.nmea in the folder or the one above; none: empty. */
std::optional<std::filesystem::path> fixesBeside(const std::filesystem::path& folder);

/** True for a file with such a name. */
bool isFixesFile(const std::filesystem::path& file);
}  // namespace delio::io
