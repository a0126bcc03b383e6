#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "delio/earth/georeference.h"
#include "delio/evaluation/comparison.h"
#include "delio/formats/trajectory.h"
#include "delio/graph/pose_graph.h"
#include "delio/map/map_builder.h"
#include "delio/odometry/imu.h"
#include "delio/odometry/wheels.h"
#include "delio/places/localisation.h"
#include "delio/places/loops.h"
#include "delio/places/stored_map.h"
#include "delio/recordings/scan_reader.h"
#include "delio/slam/options.h"
#include "delio/slam/slam.h"

namespace delio::run {
/** Times and figures of a scan under their names. Rows with the same names share them. */
class RowFigures {
 public:
    RowFigures() = default;
    /** `before`: those of the row before. */
    RowFigures(const ScanReport& report, const RowFigures& before);

    std::vector<Named> stages_ms() const;     //!< of the odometry's stages
    std::vector<Named> listeners_ms() const;  //!< of Slam's listeners
    std::vector<Named> details() const;       //!< of the odometry's method

 private:
    struct Names {
        std::vector<std::string> stages, listeners, details;
    };
    std::shared_ptr<const Names> names_;
    std::vector<double> values_;  //!< in the order of the names
};

/** A row of scans.csv. */
struct RunRow {
    std::size_t scan = 0;  //!< number of the scan in its recording
    double stamp_s = 0;    //!< seconds of the drive
    Eigen::Isometry3d sensorPose = Eigen::Isometry3d::Identity();  //!< sensor to vehicle
    std::size_t points = 0;                                        //!< that were used
    std::size_t notFinite = 0;                                     //!< Step::notFinite
    double read_ms = 0;                                            //!< time to read it
    double moved_m = 0;        //!< by the sensor since the scan before
    double turned_rad = 0;     //!< the same
    bool predicted = false;    //!< Step::predicted
    bool lost = false;         //!< Step::lost
    std::size_t track = 0;     //!< Step::track
    bool carried = false;      //!< Step::carried
    bool searched = false;     //!< Step::searched
    bool interrupted = false;  //!< Step::interrupted
    bool standing = false;     //!< Step::standing
    bool deskewed = false;     //!< Step::deskewed
    std::string reason;        //!< why it was predicted
    Quality quality;           //!< of the registration
    RowFigures figures;        //!< times and details

    /** Of reading, odometry, pose graph and submaps. */
    double total_ms() const;
};

/** The row of a scan that `report` is of. `before`: the last row; null for the first. */
RunRow rowOf(const Scan& scan, const ScanReport& report, double read_ms, const RunRow* before);

/** A drive of a live sensor. */
struct LiveRecord {
    io::LiveReport sensor;  //!< at its end
    /** From the last packet of each processed scan to its pose. */
    std::vector<double> latency_ms;
};

/** One of several LiDARs, and its pose in the vehicle: see calibrateExtrinsics(). */
struct CalibratedSensor {
    std::string label;                                        //!< as --extrinsics names it
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();   //!< sensor to vehicle
    Eigen::Isometry3d given = Eigen::Isometry3d::Identity();  //!< the same before
    /** Standard deviations along and about the vehicle's axes, relative to the first sensor:
     *  [x y z wx wy wz], metres and radians; 0: of the first sensor, or not refined. */
    Vector6 sigma = Vector6::Zero();
    std::size_t matches = 0;  //!< points on planes of the first sensor's map
    /** "along x", "about z", ...: what the drive does not show, where the given pose was kept. */
    std::vector<std::string> unobserved;
    std::string reason;  //!< why the whole pose was kept; empty: it was refined
};

/** Settings and results of a run, except the map; RunFolder writes them. */
struct RunRecord {
    std::string profile;               //!< that the options were made of
    std::vector<std::string> command;  //!< words of the command line, where there was one
    std::string drive = "drive";       //!< its name
    Options options;                   //!< of every stage

    std::vector<RunRow> rows;           //!< of the scans that were processed
    bool complete = false;              //!< every scan was processed
    std::optional<LiveRecord> live;     //!< nothing for recordings
    std::string fault;                  //!< what ended the run early, or is missing in it
    std::vector<std::string> warnings;  //!< a line each

    /** Poses of the vehicle by the odometry alone: they map its coordinates to those of the first.
     */
    io::Trajectory odometry;
    /** Poses after the pose graph; in the frame of the stored map, if the drive was found in one.
     */
    io::Trajectory final;
    double epoch_s = 0;                         //!< Unix time of second 0 of the stamps
    bool stampsRise = true;                     //!< false: the final trajectory has no times
    graph::PoseGraph graph;                     //!< optimised
    graph::OptimisationResult optimisation;     //!< of the whole graph
    double optimise_ms = 0;                     //!< time of that
    std::string storedMap;                      //!< that the drive was localised in; empty: none
    std::vector<MapFix> fixes;                  //!< of every scan, where there is one
    std::vector<places::LoopCandidate> joints;  //!< with the map's submaps, where it was extended
    bool extended = false;                      //!< the stored map got what this drive saw
    std::size_t addedSubmaps = 0;               //!< that it got
    std::optional<UpdateFigures> update;        //!< of the stored map, where it was updated
    bool searchedLoops = false;                 //!< else `loops` says nothing
    std::vector<places::LoopCandidate> loops;   //!< and what became of them
    double loop_search_ms = 0;                  //!< beside the drive, and after it

    std::optional<ImuReport> imu;          //!< what was found out about the IMU, where there is one
    std::optional<Vertical> vertical;      //!< by its accelerometer, in the frame of `final`
    std::optional<OdometryReport> wheels;  //!< likewise of wheels or another odometry
    std::optional<earth::Georeference> georeference;  //!< of the final poses, where it is known
    earth::GnssFigures gnss;                          //!< of the drive's fixes
    /** Of the imported cloud that the drive was localised in. */
    std::optional<CloudOrigin> cloudOrigin;

    /** Box about parts of the own vehicle that were found in the scans, in the vehicle's frame,
     *  metres; empty: none. */
    Eigen::AlignedBox3d ownVehicle;
    /** LiDARs whose poses were refined, the first one first; empty: none were. */
    std::vector<CalibratedSensor> extrinsics;
    io::Calibration calibration;  //!< of the drive, where there is one
    /** The final trajectory beside true poses, where they are known. */
    std::optional<evaluation::Comparison> metrics;
    /** The odometry's likewise, where the graph had something to optimise. */
    std::optional<evaluation::Comparison> metricsBefore;
    /** True poses in the frame of `final`, for pictures. */
    std::vector<Eigen::Isometry3d> truth;

    /** Loop closures, GNSS fixes or the vertical moved the poses: without them, the graph is the
     *  chain that the odometry's poses were made of. */
    bool optimised() const {
        return graph.edges().size() + 1 > graph.poses().size() || gnss.inGraph > 0 ||
               (vertical && vertical->holdsTilt);
    }
    std::size_t predicted() const;  //!< scans that were not registered
    bool isLocalised() const;       //!< it was found in the stored map
    /** Pairs of nodes, the earlier first. */
    std::vector<std::pair<std::size_t, std::size_t>> closedLoops() const;
    double path_m() const;     //!< length of the final way
    double msPerScan() const;  //!< mean of RunRow::total_ms()
};

/** A vehicle's trajectory as that of its sensor. `rows`: one for each pose. */
io::Trajectory ofSensor(const io::Trajectory& vehicle, const std::vector<RunRow>& rows);

/** Maps of a run; may be null. */
struct RunMaps {
    const map::MapBuilder* points = nullptr;  //!< of map.ply and all that is drawn
    const MapContent* stored = nullptr;       //!< for localisation
    bool keepDynamic = false;                 //!< write the removed points to a file of their own
};
}  // namespace delio::run
