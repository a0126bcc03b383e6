#pragma once
#include <iosfwd>
#include <string>
#include <vector>

#include "delio/graph/pose_graph.h"
#include "delio/io/drive_meta.h"
#include "delio/map/map_builder.h"
#include "delio/odometry.h"

namespace delio {
/** The options of every stage, as one .ini file has them: a section a stage. */
struct Options {
    OdometryOptions odometry;
    graph::PoseGraphOptions graph;
    map::MapOptions map;

    /** share/config/NAME.ini, which travels inside the library. Error for an unknown name. */
    static Options ofProfile(const std::string& name);
    static std::vector<std::string> profileNames();

    /** What a drive says of its own sensor: the vertical correction, and whether its scans are to
     * be de-skewed (KITTI's raw ones, which come without times, by azimuth). */
    void adaptTo(const io::DriveMeta& meta);

    /** Takes over the keys that are in `iniText`; throws Error that names an unknown section or
     *  key, a malformed value, or a line that is none of section, key = value and comment. */
    void load(const std::string& iniText);

    /** Takes over one `section.key=value`. Error as above. */
    void set(const std::string& assignment);

    /** Writes all of it; loading the text gives the same options. */
    void write(std::ostream& out) const;

    /** True if `iniText` sets `section.key`. */
    static bool sets(const std::string& iniText, const std::string& section,
                     const std::string& key);

 private:
    /** Sections and their options, in the order in which they are written. */
    std::vector<std::pair<std::string, StageOptions*>> stages();
};
}  // namespace delio
