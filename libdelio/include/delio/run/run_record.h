#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "delio/evaluation/comparison.h"
#include "delio/formats/trajectory.h"
#include "delio/graph/pose_graph.h"
#include "delio/localisation/anchored_graph.h"
#include "delio/loops/loop_search.h"
#include "delio/run/run_rows.h"
#include "delio/slam/options.h"

namespace delio::run {
/** What a run was asked for and found: all that a RunFolder writes, but for the map. */
struct RunRecord {
    std::string profile;               //!< that the options were made of
    std::vector<std::string> command;  //!< words of the command line, where there was one
    std::string drive = "drive";       //!< its name
    Options options;                   //!< of every stage

    RunRows rows;                       //!< of the scans that were processed
    bool complete = false;              //!< every scan was processed
    std::string fault;                  //!< what ended the run early, or is missing in it
    std::vector<std::string> warnings;  //!< a line each

    /** Poses of the vehicle by the odometry alone: they map its coordinates to those of the first.
     */
    io::Trajectory odometry;
    /** Poses after the pose graph; in the frame of the stored map, if the drive was found in one.
     */
    io::Trajectory final;
    bool stampsRise = true;                    //!< false: the final trajectory has no times
    graph::PoseGraph graph;                    //!< optimised
    graph::OptimisationResult optimisation;    //!< of the whole graph
    double optimise_ms = 0;                    //!< time of that
    std::string storedMap;                     //!< that the drive was localised in; empty: none
    std::vector<MapFix> fixes;                 //!< of every scan, where there is one
    std::vector<loops::LoopCandidate> joints;  //!< with the map's submaps, where it was extended
    bool extended = false;                     //!< the stored map got what this drive saw
    std::size_t addedSubmaps = 0;              //!< that it got
    bool searchedLoops = false;                //!< else `loops` says nothing
    std::vector<loops::LoopCandidate> loops;   //!< and what became of them
    double loop_search_ms = 0;                 //!< beside the drive, and after it

    io::Calibration calibration;  //!< of the drive, where there is one
    /** The final trajectory beside true poses, where they are known. */
    std::optional<evaluation::Comparison> metrics;
    /** The odometry's likewise, where the graph had something to optimise. */
    std::optional<evaluation::Comparison> metricsBefore;
    /** True poses in the frame of `final`, for pictures. */
    std::vector<Eigen::Isometry3d> truth;

    /** What scans have left in it, to go on later: see core/checkpoint.h. */
    template <class Archive>
    void serialize(Archive& archive) {
        archive(rows, warnings, stampsRise);
    }

    /** The chain alone is what the odometry's poses were made of: then nothing is optimised. */
    bool optimised() const { return graph.edges().size() + 1 > graph.poses().size(); }
    std::size_t predicted() const;  //!< scans that were not registered
    bool isLocalised() const;       //!< it was found in the stored map
    /** Pairs of nodes, the earlier first. */
    std::vector<std::pair<std::size_t, std::size_t>> closedLoops() const;
    double path_m() const;     //!< length of the final way
    double msPerScan() const;  //!< mean of RunRow::total_ms()
};

/** A vehicle's trajectory as that of its sensor. `rows`: one for each pose. */
io::Trajectory ofSensor(const io::Trajectory& vehicle, const RunRows& rows);
}  // namespace delio::run
