#pragma once
#include <iosfwd>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "delio/formats/drive_meta.h"
#include "delio/graph/pose_graph.h"
#include "delio/map/map_builder.h"
#include "delio/odometry/odometry.h"
#include "delio/places/localisation.h"
#include "delio/places/loops.h"
#include "delio/places/submap.h"

namespace delio {
/** Options of all stages, as in an .ini file with one section per stage. Defaults are those of the
 *  profile `accurate`; other profiles contain differences. */
struct Options : public OdometryOptions {
    graph::PoseGraphOptions graph;     //!< [graph]
    map::MapOptions map;               //!< [map], and [removal]
    places::SubmapOptions submaps;     //!< [submaps]
    places::LoopOptions loops;         //!< [loops]
    places::ClosureOptions closures;   //!< [closures]
    PlaceSearchOptions placeSearch;    //!< [place_search]
    LocalisationOptions localisation;  //!< [localisation]

    /** share/config/NAME.ini, which travels inside the library. Error for an unknown name. */
    static Options ofProfile(const std::string& name);
    static std::vector<std::string> profileNames();  //!< that ofProfile() knows

    /** The options for a drive: a profile plus the drive's metadata, as delio-slam uses them. */
    static Options forDrive(const std::string& profile, const std::optional<io::DriveMeta>& meta);

    /** Applies a drive's metadata: the vertical correction, and whether its scans are de-skewed
     *  (KITTI's raw ones, which come without times, by azimuth). */
    void adaptTo(const io::DriveMeta& meta);

    /** Takes over the keys that are in `iniText`; throws Error that names an unknown section or
     *  key, a malformed value, or a line that is not a section, key = value or comment. */
    void load(const std::string& iniText);

    /** Takes over one `section.key=value`. Error as above. */
    void set(const std::string& assignment);

    /** Throws Error that names them where options contradict each other, or where one was loaded or
     *  set that has no effect with the odometry that is chosen. Call it when all options are set.
     */
    void check() const;

    /** Writes all options in use; loading the text restores them. */
    void write(std::ostream& out) const;

    /** Those in use with their sections, in the order in which they are written. */
    ConstStageList stages() const;

    /** True if `iniText` sets `section.key`. */
    static bool sets(const std::string& iniText, const std::string& section,
                     const std::string& key);

 private:
    /** Every stage of both odometries; sections that both have are there twice. */
    StageList allStages();

    std::set<std::string> given_;  //!< sections that were loaded or set, the profile's apart
};
}  // namespace delio
