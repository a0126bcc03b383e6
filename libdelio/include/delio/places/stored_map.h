#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "delio/earth/georeference.h"
#include "delio/formats/trajectory.h"
#include "delio/graph/pose_graph.h"
#include "delio/places/submap.h"

namespace delio::places {
struct Descriptor;
}  // namespace delio::places

namespace delio {
class ByteReader;

/** A drive in a map: its scans are consecutive nodes of the map's graph. */
struct StoredDrive {
    std::string name;              //!< of its recording: io::nameOfDrive()
    std::size_t firstNode = 0;     //!< node of its first scan
    std::vector<double> stamps_s;  //!< of each of its scans
};

/** What a map has of the cloud of another program that it was imported from. */
struct CloudOrigin {
    std::size_t tiles = 0;  //!< the first submaps: squares of the cloud, without a drive
    /** Added to the map's coordinates, it gives the cloud's, metres. */
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();
    std::string wkt;  //!< coordinate system of the cloud, as OGC WKT; empty: unknown
};

/** A drive that saw a map: one of its own, or one that updated it. */
struct Visit {
    std::string name;    //!< of its recording
    double begin_s = 0;  //!< Unix time of its first scan; 0: not known
    double end_s = 0;    //!< Unix time of its last scan; 0: not known
};

/** With times where the stamps of the drive are Unix times. */
Visit visitOf(const StoredDrive& drive);

/** Points of a submap that have one history. Visits are numbers in StoredMap::visits(). */
struct PointLayer {
    /** Visits that have to see through points of the map, with none between that sees them, before
     *  these are gone. */
    static constexpr std::uint32_t kContradictions = 2;

    std::uint32_t first = 0;       //!< visit that saw them first
    std::uint32_t last = 0;        //!< visit that saw them last
    std::uint32_t against = 0;     //!< visits since that saw through them
    std::uint32_t doubted = 0;     //!< the first of these
    bool confirmed = true;         //!< by a second visit, or in the map from its start
    Eigen::Matrix3Xf points = {};  //!< metres, the submap's level frame

    /** They were seen through too often. */
    bool isGone() const { return against >= kContradictions; }
    /** A part of the map, as it is now. */
    bool isValid() const { return confirmed && !isGone(); }
    /** A part of the map at that visit, as later visits have it. */
    bool isValidAt(std::size_t visit) const {
        return confirmed && first <= visit && (!isGone() || visit < doubted);
    }
};

/** Points of the layers that are a part of the map as it is now. */
Eigen::Matrix3Xf validPoints(const std::vector<PointLayer>& layers);

/** Counts of a map's points after a visit. */
struct UpdateFigures {
    std::size_t gone = 0;       //!< seen through in this and an earlier visit: no longer in the map
    std::size_t doubted = 0;    //!< seen through for the first time: still in the map
    std::size_t confirmed = 0;  //!< seen for the second time: now in the map
    std::size_t seenOnce = 0;   //!< new: not in the map yet
    std::size_t dropped = 0;    //!< seen once before, and now seen through
};

/** Content of a stored map. Poses are the vehicle's in the map's frame, which is that of
 *  the first scan of its first drive. */
struct MapContent {
    graph::PoseGraph graph;               //!< one node per scan, of all drives
    std::vector<StoredDrive> drives;      //!< in the order of their nodes
    std::vector<places::Submap> submaps;  //!< without their points
    /** Descriptor of each of them. */
    std::function<places::Descriptor(std::size_t)> descriptor;
    /** Points of each of them: metres, its level frame. */
    std::function<Eigen::Matrix3Xf(std::size_t)> points;
    std::optional<earth::Georeference> georeference;  //!< where the map lies on the earth
    std::optional<CloudOrigin> cloud;                 //!< of an imported cloud
    std::vector<Visit> visits = {};  //!< of a map that was updated; otherwise empty
    /** Of such a map: points of each submap, instead of `points`. */
    std::function<std::vector<PointLayer>(std::size_t)> layers = {};
};

/** A map for localisation: the drives' submaps with their descriptors, and the pose graph. A file,
 * with a version, each part with a checksum; parts are read when they are asked for, by any thread.
 * Coordinates are rounded to 5 mm. */
class StoredMap {
 public:
    /** Of the file of a map that was updated. Other maps have version 2 if they have an imported
     *  cloud, and otherwise 1. */
    static constexpr std::uint32_t kVersion = 3;

    /** Throws Error if the file is missing, not a stored map, of another version, or cut off. */
    explicit StoredMap(const std::string& path);
    ~StoredMap();
    StoredMap(const StoredMap&) = delete;
    StoredMap& operator=(const StoredMap&) = delete;

    const std::string& path() const { return path_; }         //!< of the file
    const graph::PoseGraph& graph() const { return graph_; }  //!< one node per scan, of all drives
    /** Where the map lies on the earth; nothing: not known. */
    const std::optional<earth::Georeference>& georeference() const { return georeference_; }
    /** Of a map that was imported from a cloud. */
    const std::optional<CloudOrigin>& cloudOrigin() const { return cloud_; }
    /** In the order of their nodes. */
    const std::vector<StoredDrive>& drives() const { return drives_; }
    /** In the order in which they came. Of a map that was never updated: of its cloud, if there is
     *  one, and of its drives, with times where their stamps are Unix times. */
    const std::vector<Visit>& visits() const { return visits_; }
    bool isUpdated() const { return isUpdated_; }  //!< by visits after those that made it
    /** The last visit that began by then. `time`: 2026-11-28T06:00:00Z (the Z, the seconds or the
     *  time of day may be missing), or Unix seconds. Error where it is not a time, no visit has a
     *  time, or all are later. */
    std::size_t visitAt(const std::string& time) const;
    /** Without their points. */
    const std::vector<places::Submap>& submaps() const { return submaps_; }
    /** Of each submap: maps its coordinates to the map's. */
    const std::vector<Eigen::Isometry3d>& levelFrames() const { return level_; }

    /** Of one of its drives, in the map's frame. */
    io::Trajectory trajectory(const StoredDrive& drive) const;

    /** Descriptor of a submap. Error where that part of the file is damaged. */
    places::Descriptor descriptor(std::size_t submap) const;
    /** Points of a submap as they are now: metres, its level frame. Error likewise. */
    Eigen::Matrix3Xf points(std::size_t submap) const;
    /** All points of a submap, with those that are gone or were seen in one visit only. Error
     *  likewise. */
    std::vector<PointLayer> layers(std::size_t submap) const;
    /** Points that can be seen from a submap: its own, with those of tiles around a tile; metres,
     *  its level frame. Error likewise. */
    Eigen::Matrix3Xf surroundings(std::size_t submap) const;

    /** All of them in the map's frame, one in `spacing` metres; of a `visit`: as the map was
     *  then. */
    Eigen::Matrix3Xf cloud(double spacing, std::optional<std::size_t> visit = {}) const;

    /** As it would be written once more; refers to this map. */
    MapContent content() const;

    /** Writes a map: under a temporary name, so that the file at `path` is always complete. Error
     *  where that cannot be done. */
    static void save(const MapContent& content, const std::string& path);

 private:
    struct Part {
        std::uint64_t offset = 0, bytes = 0, unpacked = 0;
        std::uint32_t checksum = 0;
    };
    class Writer;
    std::vector<std::uint8_t> read(const Part& part) const;
    void readIndex(const Part& index, std::uint32_t version);
    void readVisits(ByteReader& reader);
    std::vector<Visit> visitsOfDrives() const;
    std::uint32_t visitOf(const places::Submap& submap) const;
    [[noreturn]] void damaged(const std::string& how) const;

    std::string path_;
    int file_ = -1;
    std::uint64_t size_ = 0;
    graph::PoseGraph graph_;
    std::optional<earth::Georeference> georeference_;
    std::optional<CloudOrigin> cloud_;
    std::vector<StoredDrive> drives_;
    std::vector<Visit> visits_;
    bool isUpdated_ = false;
    std::vector<places::Submap> submaps_;
    std::vector<Eigen::Isometry3d> level_;
    std::vector<Part> descriptors_, clouds_;
};

/** What became of a cloud of another program. */
struct ImportFigures {
    std::size_t points = 0;    //!< in the cloud
    std::size_t outliers = 0;  //!< of these dropped: more than 50 km from the others
    std::size_t kept = 0;      //!< points of the map
    std::size_t submaps = 0;   //!< squares of 30 m that have points
    std::size_t places = 0;    //!< of these: with free ground, where a drive can be found
    CloudOrigin origin;        //!< as the map has it
    double tilt_deg = 0;       //!< between the cloud's z axis and the normal of its ground
};

/** Makes a stored map of a .ply, .pcd or .las cloud (metres, z up within 30 degrees, any origin),
 *  so that a drive can be localised in it. Poses in the map are the cloud's coordinates less
 *  CloudOrigin::offset. Memory depends on the surface that the cloud covers, not on its number of
 *  points: about 40 bytes for each point that is kept, one in `spacing_m` (0.05 to 2 m; default:
 * 0.3 m, in a small cloud 0.15 m, as rooms need it). Throws Error where the cloud cannot be read,
 * has no ground, is too large, or the map cannot be written. The same cloud gives the same bytes.
 */
ImportFigures importCloud(const std::string& cloud, std::optional<double> spacing_m,
                          const std::string& map);
}  // namespace delio
