#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "delio/earth/fix.h"
#include "delio/earth/georeference.h"
#include "delio/formats/trajectory.h"

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

/** Writes a YAML: origin, transformation from the map to east, north, up (17 digits), covariance,
 *  UTM zone and the figures of the fixes. Throws Error if that fails. */
void writeGeoreference(const earth::Georeference& place, const earth::GnssFigures& figures,
                       const std::string& path);

/** Origin, transformation and covariance of such a file. Throws Error for one that is missing or
 *  malformed. */
earth::Georeference readGeoreference(const std::string& path);

/** Reads control points from a CSV with a header line: `x`, `y`, `z` (metres, the map's frame);
 *  `latitude`, `longitude` (deg) or `easting`, `northing` (m) and `zone` ("32N", UTM); `height` (m
 *  above the ellipsoid); and, as far as you wish, `name` and `use` (1: the point places the map, 0:
 *  it is checked). `areUsed`: where there is no column `use`. Throws Error, which names file and
 *  line, for a malformed one. */
std::vector<earth::ControlPoint> readControlPoints(const std::string& path, bool areUsed);

/** Writes a row per point: its name, whether it was used, and its error (east, north, up, metres).
 *  Throws Error if that fails. */
void writeControlErrors(const std::vector<earth::ControlPoint>& points,
                        const earth::Georeference& place, const std::string& path);

/** Writes a row per pose: stamp_s (where there are stamps), latitude, longitude (deg), height (m
 *  above the ellipsoid), east, north, up (m), UTM easting, northing (m), and heading of the
 *  vehicle's x axis (deg clockwise from true north). Throws Error if that fails. */
void writeGeoTrajectory(const Trajectory& trajectory, const earth::Georeference& place,
                        const std::string& path);

/** Writes the trajectory as a LineString of GeoJSON, one place in a metre. Throws Error if that
 *  fails. */
void writeGeoJson(const Trajectory& trajectory, const earth::Georeference& place,
                  const std::string& name, const std::string& path);
}  // namespace delio::io
