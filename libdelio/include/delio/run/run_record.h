#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "delio/evaluation/comparison.h"
#include "delio/graph/pose_graph.h"
#include "delio/io/trajectory.h"
#include "delio/localisation/anchored_graph.h"
#include "delio/loops/loop_search.h"
#include "delio/slam/options.h"
#include "delio/slam/slam.h"

namespace delio::run {
/** What is kept of one scan: a row of scans.csv. */
struct RunRow {
    std::size_t scan = 0;  //!< number of the scan in its recording
    double stamp_s = 0;
    Eigen::Isometry3d sensorPose = Eigen::Isometry3d::Identity();  //!< sensor to vehicle
    std::size_t points = 0;                                        //!< that were used
    double read_ms = 0;
    ScanReport report;  //!< without points and features

    /** Of reading, odometry, pose graph and submaps. */
    double total_ms() const;

    /** What has to be kept to go on later: see core/checkpoint.h. */
    template <class Archive>
    void serialize(Archive& archive) {
        archive(scan, stamp_s, sensorPose, points, read_ms, report);
    }
};

/** What a run was asked for and found: all that a RunFolder writes, but for the map. */
struct RunRecord {
    std::string profile;
    std::vector<std::string> command;  //!< words of the command line, where there was one
    std::string drive = "drive";       //!< its name
    Options options;

    std::vector<RunRow> rows;
    bool complete = false;              //!< every scan was processed
    std::string fault;                  //!< what ended the run early, or is missing in it
    std::vector<std::string> warnings;  //!< a line each

    /** Poses of the vehicle. `final`: after the pose graph; in the frame of the stored map, if the
     *  drive was found in one. */
    io::Trajectory odometry, final;
    bool stampsRise = true;  //!< false: the final trajectory has no times
    graph::PoseGraph graph;
    graph::OptimisationResult optimisation;
    double optimise_ms = 0;
    std::string storedMap;                     //!< that the drive was localised in; empty: none
    std::vector<MapFix> fixes;                 //!< of every scan, where there is one
    std::vector<loops::LoopCandidate> joints;  //!< with the map's submaps, where it was extended
    bool extended = false;
    std::size_t addedSubmaps = 0;
    bool searchedLoops = false;
    std::vector<loops::LoopCandidate> loops;  //!< and what became of them
    double loop_search_ms = 0;                //!< beside the drive, and after it

    io::Calibration calibration;
    /** Beside true poses, where they are known: the final trajectory, and, where the graph had
     *  something to optimise, that of the odometry. */
    std::optional<evaluation::Comparison> metrics, metricsBefore;
    /** True poses in the frame of `final`, for pictures. */
    std::vector<Eigen::Isometry3d> truth;

    /** What scans have left in it, to go on later: see core/checkpoint.h. */
    template <class Archive>
    void serialize(Archive& archive) {
        archive(rows, warnings, stampsRise);
    }

    /** The chain alone is what the odometry's poses were made of: then nothing is optimised. */
    bool optimised() const { return graph.edges().size() + 1 > graph.poses().size(); }
    std::size_t predicted() const;
    bool isLocalised() const;
    /** Pairs of nodes, the earlier first. */
    std::vector<std::pair<std::size_t, std::size_t>> closedLoops() const;
    double path_m() const;
    double msPerScan() const;
};

/** A vehicle's trajectory as that of its sensor. `rows`: one for each pose. */
io::Trajectory ofSensor(const io::Trajectory& vehicle, const std::vector<RunRow>& rows);
}  // namespace delio::run
