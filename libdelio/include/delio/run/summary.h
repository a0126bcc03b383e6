#pragma once
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "delio/run/run_record.h"

namespace delio::run {
/** A run in numbers: summary.yaml. */
struct Summary {
    using Figures = std::vector<std::pair<std::string, double>>;

    std::string version, command, profile;
    bool complete = false;
    std::string fault;  //!< empty: none
    std::size_t scans = 0, deskewed = 0;
    std::size_t predicted = 0, longest_predicted = 0;  //!< scans; of them in a row
    std::size_t weakly_observed = 0, longest_weakly_observed = 0;
    /** Of these those with an axis along which, and about which, nothing was seen, nearest to the
     *  vehicle's x, y and z. */
    std::array<std::size_t, 3> weakly_observed_along{}, weakly_observed_about{};
    std::size_t searched = 0, longest_searched = 0;
    std::size_t interrupted = 0;
    bool searched_loops = false;
    std::size_t loop_candidates = 0, loops_closed = 0;
    double loop_search_ms = 0;  //!< beside the drive, and after it
    std::string stored_map;     //!< that it was localised in; empty: none
    std::size_t in_map = 0, outside_map = 0, not_found_in_map = 0;  //!< scans
    double path_m = 0;
    double vertical_correction_deg = 0;
    double ms_per_scan = 0;         //!< reading, odometry, the graph's window, submaps
    Figures ms_per_scan_of_stages;  //!< of which these are the parts
    double map_ms_per_scan = 0;
    double optimisation_ms = 0;
    unsigned optimisation_iterations = 0;
    double optimisation_cost_before = 0, optimisation_cost_after = 0;
    double map_and_pictures_ms = 0;
    double peak_rss_mb = 0;
    std::vector<std::string> warnings;
    Figures metrics;  //!< beside true poses; empty where they are not known
    Figures metrics_before_optimisation;
};

/** `pictures_ms`: what map and pictures took to write. */
Summary summaryOf(const RunRecord& record, double pictures_ms);

/** Largest memory of this process so far, MB. */
double peakMemory_mb();

void writeSummary(const Summary& summary, const std::string& path);

/** Throws Error for a file that is missing or is no summary. */
Summary readSummary(const std::string& path);
}  // namespace delio::run
