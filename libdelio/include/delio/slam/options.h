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
/** The options of every stage, as one .ini file has them: a section a stage. The defaults are those
 *  of the profile `accurate`; the other profiles say what differs. */
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

    /** The same, and what a drive says of its own sensor: what delio-slam uses. */
    static Options forDrive(const std::string& profile, const std::optional<io::DriveMeta>& meta);

    /** What a drive says of its own sensor: the vertical correction, and whether its scans are to
     * be de-skewed (KITTI's raw ones, which come without times, by azimuth). */
    void adaptTo(const io::DriveMeta& meta);

    /** Takes over the keys that are in `iniText`; throws Error that names an unknown section or
     *  key, a malformed value, or a line that is none of section, key = value and comment. */
    void load(const std::string& iniText);

    /** Takes over one `section.key=value`. Error as above. */
    void set(const std::string& assignment);

    /** Throws Error that names them where options contradict each other, or where one was loaded
     *  or set that has no effect with the odometry that is chosen. To be asked when all are set. */
    void check() const;

    /** Writes all that has an effect; loading the text gives the same options. */
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
