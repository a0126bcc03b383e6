#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "delio/earth/georeference.h"
#include "delio/formats/trajectory.h"
#include "delio/map/map_point.h"
#include "delio/picture/scene.h"

namespace delio {
/** A map that a tool was given, with the ways through it as far as its file has them. */
struct MapInput {
    map::MapPoints points;
    std::vector<std::vector<Eigen::Isometry3d>> ways;  //!< a list of poses a drive
    std::vector<Eigen::Isometry3d> keyframes;
    std::string name;        //!< of the drive, or of the file
    map::MapPoints dynamic;  //!< removed dynamic points, if they were kept
    /** Poses of the sensor, with stamps as MapPoint::time_s has them; empty: not known. */
    io::Trajectory sensor;
    /** Poses of the first way between which a loop was closed. */
    std::vector<std::pair<std::size_t, std::size_t>> loops;
    std::optional<double> firstScan_unix_s;    //!< time of the first scan, where it is known
    std::optional<earth::Georeference> earth;  //!< where the map lies on the earth, if known
    /** Coordinates of the points' zero in the coordinate system `wkt` (of a .las, or as UTM). */
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();
    std::string wkt;  //!< coordinate system of the points plus `offset`; empty: the map's own

    /** The vehicle's; where there is no way, the origin: a map begins there. */
    Eigen::Isometry3d firstPose() const;

    /** Its direction, where the map is georeferenced. */
    std::optional<Eigen::Vector3d> north() const;

    /** As they are drawn. */
    picture::MapWays drawnWays() const;
};

/** File to read for `path`: map.ply in a result folder, else `path` itself. Throws Error if the
 *  folder has no map. */
std::string mapFileIn(const std::string& path);

/** All files that reading `path` may look into. */
std::vector<std::string> mapFilesIn(const std::string& path);

/** Reads the folder of a run, a .ply, .pcd, .las, .simplemap or .delio.
 *  @param storedSpacing_m of a .delio one point in so many metres is taken; 0: all
 *  @param at time as StoredMap::visitAt() has it: a .delio as it was then; empty: as it is now
 *  Throws Error for another kind of file, where it cannot be read, and for a map without points. */
MapInput readMap(const std::string& path, double storedSpacing_m, const std::string& at = "");
}  // namespace delio
