#pragma once
#include <functional>
#include <string>
#include <vector>

#include "delio/io/scan_table.h"
#include "delio/run/localisation_table.h"
#include "delio/run/loop_table.h"
#include "delio/run/run_maps.h"
#include "delio/run/run_record.h"
#include "delio/run/summary.h"

namespace delio::run {
class RunFolder;

/** The file of a stored map: `path` itself, or the one in the folder of a run. Error where there is
 *  none. */
std::string storedMapIn(const std::string& path);

/** Draws what a run found into its folder: RunFolder::kScene, kMapPicture (where there are points),
 *  kRemovalPicture (where something was taken out of them) and kTrajectoryPicture. delio::picture
 * has one; without, there are no pictures. */
using Illustrate =
    std::function<void(const RunRecord& record, const map::BuiltMap& map, const RunFolder& folder)>;

/** The folder that a run leaves. Every result file has its name, its writer and its reader here.
 *  All are written into an io::PartialFolder first and put in their places together, summary.yaml
 *  last: a folder that has one is whole. */
class RunFolder {
 public:
    static constexpr const char* kTrajectory = "trajectory_kitti.txt";
    static constexpr const char* kOdometry = "trajectory_odometry_kitti.txt";
    static constexpr const char* kCam0 = "trajectory_kitti_cam0.txt";
    static constexpr const char* kOdometryCam0 = "trajectory_odometry_kitti_cam0.txt";
    static constexpr const char* kTum = "trajectory_tum.txt";
    static constexpr const char* kGraph = "posegraph.g2o";
    static constexpr const char* kMrptGraph = "posegraph.graph";
    static constexpr const char* kScans = "scans.csv";
    static constexpr const char* kLoops = "loops.csv";  //!< where loops were searched for
    static constexpr const char* kLocalisation = "localisation.csv";  //!< in a stored map
    static constexpr const char* kJoints = "joints.csv";              //!< where one was extended
    static constexpr const char* kConfig = "config.ini";
    static constexpr const char* kSimplemap = "map.simplemap";
    static constexpr const char* kPly = "map.ply";
    static constexpr const char* kDynamicPly = "map_dynamic.ply";  //!< what was taken out of it
    static constexpr const char* kMapPage = "map.html";
    static constexpr const char* kStoredMap = "map.delio";
    static constexpr const char* kScene = "map.3Dscene";
    static constexpr const char* kMapPicture = "map.png";
    static constexpr const char* kRemovalPicture = "map_removal.png";  //!< before and after it
    static constexpr const char* kTrajectoryPicture = "trajectory.png";
    static constexpr const char* kSummary = "summary.yaml";

    explicit RunFolder(std::string folder) : folder_(std::move(folder)) {}

    /** Of one of the names above. */
    std::string path(const char* name) const;
    bool has(const char* name) const;
    /** Paths of all that write() replaces or takes away. */
    std::vector<std::string> files() const;

    /** Writes all that the record has (making the folder where it is not there); files of an
     * earlier run that this one does not have are removed. Returns what is
     * missing: the record's fault, or why map or pictures could not be made; empty if nothing.
     * Where anything else cannot be written, Error, and what was there before is as it was. */
    std::string write(RunRecord record, const RunMaps& maps = {},
                      const Illustrate& illustrate = {}) const;

    /** What is in the folder. Each throws Error where the file is missing or malformed. */
    io::Trajectory trajectory() const { return io::readTrajectory(path(kTrajectory)); }
    io::Trajectory odometry() const { return io::readTrajectory(path(kOdometry)); }
    io::Trajectory cam0() const { return io::readTrajectory(path(kCam0)); }
    io::Trajectory tum() const { return io::readTrajectory(path(kTum)); }
    graph::PoseGraph graph() const;
    io::ScanTable scans() const { return io::readScanTable(path(kScans)); }
    std::vector<LoopRow> loops() const { return readLoopTable(path(kLoops)); }
    std::vector<LoopRow> joints() const { return readLoopTable(path(kJoints)); }
    std::vector<LocalisationRow> localisation() const {
        return readLocalisationTable(path(kLocalisation));
    }
    StoredMap storedMap() const { return StoredMap(path(kStoredMap)); }
    /** The options that were in effect. */
    Options options() const;
    Summary summary() const { return readSummary(path(kSummary)); }

 private:
    void writeTables(const RunRecord& record) const;
    void writeTrajectories(const RunRecord& record) const;
    void writeMaps(const RunRecord& record, const RunMaps& maps,
                   const Illustrate& illustrate) const;

    std::string folder_;
};
}  // namespace delio::run
