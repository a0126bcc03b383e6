#pragma once
#include <functional>
#include <string>
#include <vector>

#include "delio/formats/scan_table.h"
#include "delio/places/localisation.h"
#include "delio/places/stored_map.h"
#include "delio/run/run_record.h"
#include "delio/run/summary.h"

namespace delio::run {
class RunFolder;

/** A row of loops.csv. */
struct LoopRow {
    std::size_t fromNode = 0;  //!< of the pose graph, the earlier
    std::size_t toNode = 0;    //!< the later
    bool accepted = false;     //!< both are one place
    std::string reason;        //!< why it was not
};

/** A row of localisation.csv. */
struct LocalisationRow {
    std::size_t scan = 0;                       //!< its number in its recording
    Whereabouts where = Whereabouts::kUnknown;  //!< with respect to the map
    bool measured = false;                      //!< registered to the map
};

/** The file of a stored map: `path` itself, or the one in the folder of a run. Throws Error if
 *  there is no such file. */
std::string storedMapIn(const std::string& path);

/** Draws what a run found into its folder: RunFolder::kScene, kMapPicture (where there are points),
 *  kRemovalPicture (where something was taken out of them) and kTrajectoryPicture. delio::picture
 * has one; without, there are no pictures. */
using Illustrate =
    std::function<void(const RunRecord& record, const map::BuiltMap& map, const RunFolder& folder)>;

/** Result folder of a run. Every result file has its name, its writer and its reader here. All are
 *  written into an io::PartialFolder first and put in their places together, summary.yaml last: a
 *  folder with this file is complete. */
class RunFolder {
 public:
    /** Final poses, in KITTI's format. */
    static constexpr const char* kTrajectory = "trajectory_kitti.txt";
    /** Poses before the pose graph, likewise. */
    static constexpr const char* kOdometry = "trajectory_odometry_kitti.txt";
    /** Final poses in KITTI's cam0 frame. */
    static constexpr const char* kCam0 = "trajectory_kitti_cam0.txt";
    /** Poses before the pose graph, likewise, where it changed them. */
    static constexpr const char* kOdometryCam0 = "trajectory_odometry_kitti_cam0.txt";
    static constexpr const char* kTum = "trajectory_tum.txt";  //!< final poses with times
    /** Final poses with Unix times: text of MRPT's pose interpolator. */
    static constexpr const char* kInterpolator = "trajectory_mrpt.txt";
    static constexpr const char* kGeoreference = "georeference.yaml";    //!< of a drive with fixes
    static constexpr const char* kGeoTrajectory = "trajectory_geo.csv";  //!< on the earth
    static constexpr const char* kEnuTum = "trajectory_enu_tum.txt";     //!< east, north, up
    static constexpr const char* kGeoJson = "trajectory.geojson";        //!< for maps
    /** In the coordinates of an imported cloud that has an offset. */
    static constexpr const char* kCloudTum = "trajectory_cloud_tum.txt";
    static constexpr const char* kGraph = "posegraph.g2o";  //!< for g2o, and to be optimised again
    static constexpr const char* kMrptGraph = "posegraph.graph";  //!< MRPT's text format
    static constexpr const char* kScans = "scans.csv";            //!< one row per scan
    static constexpr const char* kLoops = "loops.csv";            //!< where loops were searched for
    static constexpr const char* kLocalisation = "localisation.csv";  //!< in a stored map
    static constexpr const char* kJoints = "joints.csv";              //!< where one was extended
    /** Refined poses of several LiDARs, for ScanSource::extrinsicsFile. */
    static constexpr const char* kExtrinsics = "extrinsics.txt";
    static constexpr const char* kConfig = "config.ini";        //!< every option that had an effect
    static constexpr const char* kSimplemap = "map.simplemap";  //!< MRPT's keyframes with points
    static constexpr const char* kPly = "map.ply";              //!< points of the map
    static constexpr const char* kDynamicPly = "map_dynamic.ply";      //!< removed dynamic points
    static constexpr const char* kMapPage = "map.html";                //!< the map for a browser
    static constexpr const char* kStoredMap = "map.delio";             //!< for StoredMap
    static constexpr const char* kScene = "map.3Dscene";               //!< for SceneViewer3D
    static constexpr const char* kMapPicture = "map.png";              //!< the map, obliquely
    static constexpr const char* kRemovalPicture = "map_removal.png";  //!< before and after it
    static constexpr const char* kTrajectoryPicture =
        "trajectory.png";                                    //!< the trajectory from above
    static constexpr const char* kPackets = "packets.pcap";  //!< of a live sensor, as they came
    static constexpr const char* kSummary = "summary.yaml";  //!< the run in numbers
    /** With several drives: the map of each drive. */
    static constexpr const char* kDrives = "drives.csv";

    /** Folder of a run in progress: its rows so far, see RunSettings::folder. */
    static constexpr const char* kIncomplete = "incomplete";

    /** It need not be there yet. */
    explicit RunFolder(std::string folder) : folder_(std::move(folder)) {}

    /** Of one of the names above. */
    std::string path(const char* name) const;
    bool has(const char* name) const;  //!< there is such a file
    /** Paths that write() replaces or removes. */
    std::vector<std::string> files() const;

    /** Writes all that the record has (making the folder where it is not there); files of an
     *  earlier run that this one does not have are removed. Returns what is missing: the record's
     *  fault, or why map or pictures could not be made; empty if nothing. Throws Error if anything
     *  else cannot be written; existing files are then unchanged. */
    std::string write(RunRecord record, const RunMaps& maps = {},
                      const Illustrate& illustrate = {}) const;

    /** Final poses. As all of these it throws Error where the file is missing or malformed. */
    io::Trajectory trajectory() const { return io::readTrajectory(path(kTrajectory)); }
    /** Poses before the pose graph. */
    io::Trajectory odometry() const { return io::readTrajectory(path(kOdometry)); }
    io::Trajectory cam0() const { return io::readTrajectory(path(kCam0)); }  //!< of kCam0
    io::Trajectory tum() const { return io::readTrajectory(path(kTum)); }    //!< with stamps
    graph::PoseGraph graph() const;                                          //!< of kGraph
    io::ScanTable scans() const { return io::readScanTable(path(kScans)); }  //!< of kScans
    std::vector<LoopRow> loops() const;                                      //!< of kLoops
    std::vector<LoopRow> joints() const;                                     //!< of kJoints
    std::vector<LocalisationRow> localisation() const;                       //!< of kLocalisation
    StoredMap storedMap() const { return StoredMap(path(kStoredMap)); }      //!< of kStoredMap
    /** The options that were in effect. */
    Options options() const;
    Summary summary() const { return readSummary(path(kSummary)); }  //!< of kSummary

 private:
    void writeTables(const RunRecord& record) const;
    void writeTrajectories(const RunRecord& record) const;
    void writeMaps(const RunRecord& record, const RunMaps& maps,
                   const Illustrate& illustrate) const;

    std::string folder_;
};
}  // namespace delio::run
