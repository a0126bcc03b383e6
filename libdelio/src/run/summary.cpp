#include "delio/run/summary.h"

#include <sys/resource.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string_view>

#include "core/percentile.h"
#include "delio/core/error.h"
#include "delio/core/numbers.h"
#include "delio/files/output_file.h"
#include "delio/run/doubts.h"
#include "delio/version.h"

namespace delio::run {
namespace {
Summary::Figures figuresOf(const evaluation::Comparison& comparison) {
    Summary::Figures figures;
    const auto put = [&](const char* name, double value) {
        if (std::isfinite(value)) figures.emplace_back(name, value);  // a short drive has not all
    };
    const auto& row = comparison.row;
    put("length_m", row.length_m);
    put("segments", static_cast<double>(row.kitti.segments));
    put("t_percent", row.kitti.t_percent);
    put("r_deg_per_100m", row.kitti.r_deg_per_100m);
    put("ape_m", row.ape_m);
    put("end_error_m", comparison.end_error_m);
    put("end_error_percent", comparison.endError_percent());
    put("scan_translation_median_m", comparison.perScan.translation_m.median);
    put("scan_translation_p95_m", comparison.perScan.translation_m.p95);
    put("scan_rotation_median_deg", comparison.perScan.rotation_deg.median);
    put("scan_rotation_p95_deg", comparison.perScan.rotation_deg.p95);
    return figures;
}

/** Sums of the times of all rows, each under its name, in the order of the first row. */
void add(const std::vector<Named>& times, Summary::Figures& sums) {
    for (const auto& [name, ms] : times) {
        const auto sum = std::find_if(sums.begin(), sums.end(), [name = name](const auto& entry) {
            return entry.first == name;
        });
        if (sum == sums.end())
            sums.emplace_back(name, ms);
        else
            sum->second += ms;
    }
}

Summary::Figures meanTimes(const RunRecord& record) {
    Summary::Figures means{{"read", 0}};
    for (const auto& row : record.rows) {
        means.front().second += row.read_ms;
        add(row.figures.stages_ms(), means);
        add(row.figures.listeners_ms(), means);
    }
    for (auto& [name, ms] : means)
        ms /= static_cast<double>(std::max<std::size_t>(record.rows.size(), 1));
    return means;
}

template <typename Flag>
std::size_t countOf(const RunRecord& record, const Flag& flag) {
    return static_cast<std::size_t>(std::count_if(record.rows.begin(), record.rows.end(),
                                                  [&](const RunRow& row) { return row.*flag; }));
}

std::string wordsOf(const std::vector<std::string>& words) {
    std::string text;
    for (const auto& word : words) text += (text.empty() ? "" : " ") + word;
    return text;
}

void write(YAML::Emitter& yaml, const char* key, const std::string& text) {
    yaml << YAML::Key << key << YAML::Value << YAML::DoubleQuoted << text << YAML::Auto;
}
/** Counts are written as such: 100000 as a double would be 1e+05, which is no whole number. */
template <typename Number>
void write(YAML::Emitter& yaml, const std::string& key, Number value) {
    yaml << YAML::Key << key << YAML::Value << digitsOf(value);
}
void write(YAML::Emitter& yaml, const char* key, const Summary::Figures& figures) {
    yaml << YAML::Key << key << YAML::Value << YAML::BeginMap;
    for (const auto& [name, value] : figures) write(yaml, name, value);
    yaml << YAML::EndMap;
}

void write(YAML::Emitter& yaml, const char* key, const std::array<std::size_t, 3>& counts) {
    yaml << YAML::Key << key << YAML::Value << YAML::Flow << YAML::BeginMap;
    for (std::size_t k = 0; k < 3; ++k) write(yaml, std::string(1, "xyz"[k]), counts[k]);
    yaml << YAML::EndMap;
}

/** Like yaml-cpp's as(), which depends on the locale. */
template <typename Number>
Number numberOf(const YAML::Node& node) {
    const auto number = numberIn<Number>(node.as<std::string>());
    if (!number) throw YAML::TypedBadConversion<Number>(node.Mark());
    return *number;
}
template <typename Number>
Number numberOf(const YAML::Node& node, Number otherwise) {
    return node ? numberOf<Number>(node) : otherwise;
}

std::array<std::size_t, 3> countsIn(const YAML::Node& node) {
    if (!node) return {};
    return {numberOf<std::size_t>(node["x"]), numberOf<std::size_t>(node["y"]),
            numberOf<std::size_t>(node["z"])};
}

Summary::Figures figuresIn(const YAML::Node& node) {
    Summary::Figures figures;
    for (const auto& entry : node)
        figures.emplace_back(entry.first.as<std::string>(), numberOf<double>(entry.second));
    return figures;
}
}  // namespace

Summary::Figures latencyOf(const std::vector<RunRow>& rows) {
    std::vector<double> ms;
    ms.reserve(rows.size() + 1);
    for (const auto& row : rows) ms.push_back(row.total_ms());
    if (ms.empty()) ms.push_back(0);
    std::sort(ms.begin(), ms.end());
    return {{"median", percentileOf(ms, 50)}, {"p95", percentileOf(ms, 95)}, {"worst", ms.back()}};
}

double peakMemory_mb() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

Summary summaryOf(const RunRecord& record, double pictures_ms) {
    Summary summary;
    summary.version = kVersion;
    summary.command = wordsOf(record.command);
    summary.profile = record.profile;
    summary.complete = record.complete;
    summary.fault = record.fault;
    summary.scans = record.rows.empty() ? record.final.poses.size() : record.rows.size();
    const Doubts doubts = doubtsOf(record.rows);
    summary.predicted = countOf(record, &RunRow::predicted);
    summary.longest_predicted = doubts.predicted.longest;
    summary.weakly_observed = doubts.weak.scans;
    summary.longest_weakly_observed = doubts.weak.longest;
    summary.interrupted = doubts.interrupted.scans;
    summary.standing = doubts.standing.scans;
    summary.weakly_observed_along = doubts.weakAlong;
    summary.weakly_observed_about = doubts.weakAbout;
    summary.searched = countOf(record, &RunRow::searched);
    summary.longest_searched = doubts.searched.longest;
    summary.searched_loops = record.searchedLoops;
    summary.loop_candidates = record.loops.size();
    summary.loops_closed = record.closedLoops().size();
    summary.loop_search_ms = record.loop_search_ms;
    summary.stored_map = record.storedMap;
    for (const auto& fix : record.fixes)
        ++(fix.where == Whereabouts::kInMap     ? summary.in_map
           : fix.where == Whereabouts::kOutside ? summary.outside_map
                                                : summary.not_found_in_map);
    summary.deskewed = countOf(record, &RunRow::deskewed);
    summary.path_m = record.path_m();
    summary.vertical_correction_deg = record.options.scan().vertical_correction_deg;
    summary.ms_per_scan = record.msPerScan();
    summary.latency_ms = latencyOf(record.rows);
    for (const auto& [name, ms] : meanTimes(record))
        if (name == "map")
            summary.map_ms_per_scan = ms;
        else
            summary.ms_per_scan_of_stages.emplace_back(name, ms);
    summary.optimisation_ms = record.optimise_ms;
    summary.optimisation_iterations = record.optimisation.iterations;
    summary.optimisation_cost_before = record.optimisation.initial_cost;
    summary.optimisation_cost_after = record.optimisation.final_cost;
    summary.map_and_pictures_ms = pictures_ms;
    summary.peak_rss_mb = peakMemory_mb();
    summary.warnings = record.warnings;
    if (record.metrics) summary.metrics = figuresOf(*record.metrics);
    if (record.metricsBefore)
        summary.metrics_before_optimisation = figuresOf(*record.metricsBefore);
    return summary;
}

void writeSummary(const Summary& s, const std::string& path) {
    YAML::Emitter yaml;
    yaml << YAML::BeginMap;
    write(yaml, "version", s.version);
    write(yaml, "command", s.command);
    write(yaml, "profile", s.profile);
    yaml << YAML::Key << "complete" << YAML::Value << s.complete;
    if (!s.fault.empty()) write(yaml, "fault", s.fault);
    write(yaml, "scans", s.scans);
    write(yaml, "predicted", s.predicted);
    write(yaml, "longest_predicted", s.longest_predicted);
    write(yaml, "weakly_observed", s.weakly_observed);
    write(yaml, "longest_weakly_observed", s.longest_weakly_observed);
    write(yaml, "weakly_observed_along", s.weakly_observed_along);
    write(yaml, "weakly_observed_about", s.weakly_observed_about);
    write(yaml, "searched", s.searched);
    write(yaml, "longest_searched", s.longest_searched);
    write(yaml, "interrupted", s.interrupted);
    write(yaml, "standing", s.standing);
    if (s.searched_loops) {
        write(yaml, "loop_candidates", s.loop_candidates);
        write(yaml, "loops_closed", s.loops_closed);
        write(yaml, "loop_search_ms", s.loop_search_ms);
    }
    if (!s.stored_map.empty()) {
        write(yaml, "stored_map", s.stored_map);
        write(yaml, "in_map", s.in_map);
        write(yaml, "outside_map", s.outside_map);
        write(yaml, "not_found_in_map", s.not_found_in_map);
    }
    write(yaml, "path_m", s.path_m);
    write(yaml, "vertical_correction_deg", s.vertical_correction_deg);
    write(yaml, "deskewed", s.deskewed);
    write(yaml, "ms_per_scan", s.ms_per_scan);
    write(yaml, "ms_per_scan_of_stages", s.ms_per_scan_of_stages);
    write(yaml, "latency_ms", s.latency_ms);
    write(yaml, "map_ms_per_scan", s.map_ms_per_scan);
    write(yaml, "optimisation_ms", s.optimisation_ms);
    write(yaml, "optimisation_iterations", s.optimisation_iterations);
    write(yaml, "optimisation_cost_before", s.optimisation_cost_before);
    write(yaml, "optimisation_cost_after", s.optimisation_cost_after);
    write(yaml, "map_and_pictures_ms", s.map_and_pictures_ms);
    write(yaml, "peak_rss_mb", s.peak_rss_mb);
    yaml << YAML::Key << "warnings" << YAML::Value;
    if (s.warnings.empty()) yaml << YAML::Flow;
    yaml << YAML::BeginSeq;
    for (const auto& warning : s.warnings) yaml << YAML::DoubleQuoted << warning;
    yaml << YAML::EndSeq;
    if (!s.metrics.empty()) write(yaml, "metrics", s.metrics);
    if (!s.metrics_before_optimisation.empty())
        write(yaml, "metrics_before_optimisation", s.metrics_before_optimisation);
    yaml << YAML::EndMap;
    io::replaceTextFile(path, [&](std::ostream& out) { out << yaml.c_str() << "\n"; });
}

Summary readSummary(const std::string& path) {
    try {
        const YAML::Node node = YAML::LoadFile(path);
        Summary s;
        s.version = node["version"].as<std::string>();
        s.command = node["command"].as<std::string>();
        s.profile = node["profile"].as<std::string>();
        s.complete = node["complete"].as<bool>();
        s.fault = node["fault"].as<std::string>("");
        s.scans = numberOf<std::size_t>(node["scans"]);
        s.predicted = numberOf<std::size_t>(node["predicted"]);
        s.longest_predicted = numberOf<std::size_t>(node["longest_predicted"], 0);
        s.weakly_observed = numberOf<std::size_t>(node["weakly_observed"], 0);
        s.longest_weakly_observed = numberOf<std::size_t>(node["longest_weakly_observed"], 0);
        s.weakly_observed_along = countsIn(node["weakly_observed_along"]);
        s.weakly_observed_about = countsIn(node["weakly_observed_about"]);
        s.searched = numberOf<std::size_t>(node["searched"], 0);
        s.longest_searched = numberOf<std::size_t>(node["longest_searched"], 0);
        s.interrupted = numberOf<std::size_t>(node["interrupted"], 0);
        s.standing = numberOf<std::size_t>(node["standing"], 0);
        s.searched_loops = static_cast<bool>(node["loops_closed"]);
        s.loop_candidates = numberOf<std::size_t>(node["loop_candidates"], 0);
        s.loops_closed = numberOf<std::size_t>(node["loops_closed"], 0);
        s.loop_search_ms = numberOf<double>(node["loop_search_ms"], 0);
        s.stored_map = node["stored_map"].as<std::string>("");
        s.in_map = numberOf<std::size_t>(node["in_map"], 0);
        s.outside_map = numberOf<std::size_t>(node["outside_map"], 0);
        s.not_found_in_map = numberOf<std::size_t>(node["not_found_in_map"], 0);
        s.deskewed = numberOf<std::size_t>(node["deskewed"]);
        s.path_m = numberOf<double>(node["path_m"]);
        s.vertical_correction_deg = numberOf<double>(node["vertical_correction_deg"]);
        s.ms_per_scan = numberOf<double>(node["ms_per_scan"]);
        s.ms_per_scan_of_stages = figuresIn(node["ms_per_scan_of_stages"]);
        s.latency_ms = figuresIn(node["latency_ms"]);
        s.map_ms_per_scan = numberOf<double>(node["map_ms_per_scan"]);
        s.optimisation_ms = numberOf<double>(node["optimisation_ms"]);
        s.optimisation_iterations = numberOf<unsigned>(node["optimisation_iterations"]);
        s.optimisation_cost_before = numberOf<double>(node["optimisation_cost_before"]);
        s.optimisation_cost_after = numberOf<double>(node["optimisation_cost_after"]);
        s.map_and_pictures_ms = numberOf<double>(node["map_and_pictures_ms"]);
        s.peak_rss_mb = numberOf<double>(node["peak_rss_mb"]);
        s.warnings = node["warnings"].as<std::vector<std::string>>();
        s.metrics = figuresIn(node["metrics"]);
        s.metrics_before_optimisation = figuresIn(node["metrics_before_optimisation"]);
        return s;
    } catch (const std::exception& e) {
        throw Error("cannot parse '" + path + "': " + plainMessage(e));
    }
}
}  // namespace delio::run
