#pragma once
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "delio/run/run_record.h"

namespace delio::run {
/** Summary of a run: summary.yaml. */
struct Summary {
    /** Names and numbers, in an order. */
    using Figures = std::vector<std::pair<std::string, double>>;

    std::string version;                      //!< of DeLiO
    std::string command;                      //!< command line, if any
    std::string profile;                      //!< that the options were made of
    bool complete = false;                    //!< every scan was processed
    std::string fault;                        //!< empty: none
    std::size_t scans = 0;                    //!< that were processed
    std::size_t deskewed = 0;                 //!< scans whose points had times
    std::size_t predicted = 0;                //!< scans that were not registered
    std::size_t longest_predicted = 0;        //!< longest run of them
    std::size_t lost = 0;                     //!< scans since which the motion is not known
    std::size_t longest_lost = 0;             //!< longest run of them
    std::size_t unlinked = 0;                 //!< unlinkedOf()
    std::size_t tracked = 0;                  //!< registered along every axis
    std::size_t weakly_observed = 0;          //!< registered, with a degenerate axis
    std::size_t longest_weakly_observed = 0;  //!< longest run of them
    /** Weakly observed scans by the vehicle's axis (x, y, z) nearest to the degenerate one. */
    std::array<std::size_t, 3> weakly_observed_along{};
    std::array<std::size_t, 3> weakly_observed_about{};  //!< the same about which
    std::size_t searched = 0;                            //!< scans with a wide search
    std::size_t longest_searched = 0;                    //!< longest run of them
    std::size_t interrupted = 0;                         //!< scans after a pause or a set clock
    std::size_t standing = 0;                            //!< scans in which the sensor stood still
    bool searched_loops = false;                         //!< otherwise the next two are meaningless
    std::size_t loop_candidates = 0;                     //!< pairs of places that were compared
    std::size_t loops_closed = 0;                        //!< accepted pairs
    double loop_search_ms = 0;                           //!< beside the drive, and after it
    std::string stored_map;                              //!< that it was localised in; empty: none
    std::size_t in_map = 0;                              //!< scans in the stored map
    std::size_t outside_map = 0;                         //!< scans after it was left
    std::size_t not_found_in_map = 0;                    //!< scans before it was found
    /** Samples, calibration and residual of the IMU, where there is one. */
    Figures imu;
    Figures odometry;     //!< samples, scale and agreement of wheels, where there are any
    Figures own_vehicle;  //!< corners of its parts' box, where any were found
    /** Pose and standard deviations of each LiDAR whose pose was refined, after its label. */
    Figures extrinsics;
    Figures georeference;                  //!< empty: not georeferenced
    double path_m = 0;                     //!< length of the final way
    double vertical_correction_deg = 0;    //!< that was added to each point's vertical angle
    double ms_per_scan = 0;                //!< reading, odometry, the graph's window, submaps
    Figures ms_per_scan_of_stages;         //!< the same by stage
    Figures latency_ms;                    //!< latencyOf()
    Figures live;                          //!< of a live sensor; empty: a recording
    double map_ms_per_scan = 0;            //!< time of the map per scan
    double optimisation_ms = 0;            //!< of the whole graph
    unsigned optimisation_iterations = 0;  //!< Levenberg-Marquardt steps tried
    double optimisation_cost_before = 0;   //!< OptimisationResult::initial_cost
    double optimisation_cost_after = 0;    //!< OptimisationResult::final_cost
    double map_and_pictures_ms = 0;        //!< to build and write them
    double peak_rss_mb = 0;                //!< peakMemory_mb()
    std::vector<std::string> warnings;     //!< a line each
    Figures metrics;                       //!< beside true poses; empty where they are not known
    Figures metrics_before_optimisation;   //!< of the odometry, where the graph changed it
};

/** `pictures_ms`: what map and pictures took to write. */
Summary summaryOf(const RunRecord& record, double pictures_ms);

/** Latency from the request of a scan to its pose, ms (RunRow::total_ms()): median, p95 and worst.
 */
Summary::Figures latencyOf(const std::vector<RunRow>& rows);

/** Packets and scans of a live sensor, and latency from the last packet of a scan to its pose, ms:
 *  median, p99 and worst. */
Summary::Figures liveFiguresOf(const LiveRecord& live);

/** Largest memory of this process so far, MB. */
double peakMemory_mb();

/** As YAML. Error where it cannot be written. */
void writeSummary(const Summary& summary, const std::string& path);

/** Throws Error for a file that is missing or is no summary. */
Summary readSummary(const std::string& path);
}  // namespace delio::run
