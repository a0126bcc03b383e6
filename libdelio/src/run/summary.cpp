#include "delio/run/summary.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <ostream>
#include <type_traits>

#include "core/percentile.h"
#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/core/text.h"
#include "delio/files/output.h"
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

Summary::Figures georeferenceOf(const RunRecord& record) {
    if (!record.georeference) return {};
    const auto& place = *record.georeference;
    const auto& gnss = record.gnss;
    Summary::Figures figures{{"latitude_deg", place.origin.latitude_deg},
                             {"longitude_deg", place.origin.longitude_deg},
                             {"height_m", place.origin.height_m},
                             {"heading_deg", earth::heading_deg(place.enuFromMap)}};
    if (gnss.fixes == 0) return figures;  // that of a stored map
    const Summary::Figures ofFixes{{"heading_sigma_deg", gnss.headingSigma_deg},
                                   {"origin_sigma_east_m", gnss.originSigma_m.x()},
                                   {"origin_sigma_north_m", gnss.originSigma_m.y()},
                                   {"origin_sigma_up_m", gnss.originSigma_m.z()},
                                   {"fixes", static_cast<double>(gnss.fixes)},
                                   {"fixes_used", static_cast<double>(gnss.used)},
                                   {"fixes_rejected", static_cast<double>(gnss.rejected)},
                                   {"fixes_in_graph", static_cast<double>(gnss.inGraph)},
                                   {"rms_m", gnss.rms_m},
                                   {"rms_up_m", gnss.rmsUp_m}};
    figures.insert(figures.end(), ofFixes.begin(), ofFixes.end());
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

void addStages(const RunRecord& record, Summary& summary) {
    for (const auto& [name, ms] : meanTimes(record))
        if (name == "map")
            summary.map_ms_per_scan = ms;
        else
            summary.ms_per_scan_of_stages.emplace_back(name, ms);
}

template <typename Flag>
std::size_t countOf(const RunRecord& record, const Flag& flag) {
    return static_cast<std::size_t>(std::count_if(record.rows.begin(), record.rows.end(),
                                                  [&](const RunRow& row) { return row.*flag; }));
}

/** Rotations as roll, pitch and yaw: rotations about x, then y, then z. */
Summary::Figures figuresOf(const ImuReport& imu) {
    constexpr double kDegrees = 180 / M_PI;
    Summary::Figures figures{{"samples", static_cast<double>(imu.samples)},
                             {"dropped", static_cast<double>(imu.dropped)},
                             {"scans_used", static_cast<double>(imu.scansUsed)},
                             {"scans_without_samples", static_cast<double>(imu.scansWithout)}};
    const auto put = [&](const char* name, double value) { figures.emplace_back(name, value); };
    if (!imu.rotation) return figures;
    put("bias_x_deg_per_s", kDegrees * imu.bias_radps.x());
    put("bias_y_deg_per_s", kDegrees * imu.bias_radps.y());
    put("bias_z_deg_per_s", kDegrees * imu.bias_radps.z());
    put("residual_deg", kDegrees * imu.residual_rad);
    const Eigen::Matrix3d& R = *imu.rotation;
    put("roll_deg", kDegrees * std::atan2(R(2, 1), R(2, 2)));
    put("pitch_deg", kDegrees * -std::asin(std::clamp(R(2, 0), -1.0, 1.0)));
    put("yaw_deg", kDegrees * std::atan2(R(1, 0), R(0, 0)));
    if (imu.rotationSigma_rad) put("rotation_sigma_deg", kDegrees * *imu.rotationSigma_rad);
    put("offset_ms", 1e3 * imu.offset_s);
    if (imu.offsetSigma_s) put("offset_sigma_ms", 1e3 * *imu.offsetSigma_s);
    return figures;
}

/** Appends to those of the IMU. */
void put(const Vertical& vertical, Summary::Figures& figures) {
    if (!vertical.refusal.empty()) return;
    figures.insert(
        figures.end(),
        {{"up_x", vertical.up.x()},
         {"up_y", vertical.up.y()},
         {"up_z", vertical.up.z()},
         {"up_sigma_deg", 180 / M_PI * vertical.sigma_rad},
         {"acceleration_bias_x_mps2", vertical.bias_mps2.x()},
         {"acceleration_bias_y_mps2", vertical.bias_mps2.y()},
         {"acceleration_bias_z_mps2", vertical.bias_mps2.z()},
         {"tilts_held", vertical.holdsTilt ? static_cast<double>(vertical.stretches) : 0}});
}

Summary::Figures figuresOf(const OdometryReport& wheels) {
    Summary::Figures figures{{"samples", static_cast<double>(wheels.samples)},
                             {"dropped", static_cast<double>(wheels.dropped)},
                             {"jumps", static_cast<double>(wheels.jumps)},
                             {"scans_carried", static_cast<double>(wheels.scansCarried)},
                             {"scans_without_samples", static_cast<double>(wheels.scansWithout)},
                             {"stretches", static_cast<double>(wheels.compared)},
                             {"stretches_off", static_cast<double>(wheels.contradicting)},
                             {"scale", wheels.scale}};
    if (wheels.sigma) figures.emplace_back("sigma_m_per_m", *wheels.sigma);
    return figures;
}

/** Of the corners, metres. */
Summary::Figures figuresOf(const Eigen::AlignedBox3d& box) {
    if (box.isEmpty()) return {};
    return {{"min_x_m", box.min().x()}, {"min_y_m", box.min().y()}, {"min_z_m", box.min().z()},
            {"max_x_m", box.max().x()}, {"max_y_m", box.max().y()}, {"max_z_m", box.max().z()}};
}

/** In MRPT's order, each after the sensor's label; standard deviations about x, y and z. */
Summary::Figures figuresOf(const std::vector<CalibratedSensor>& sensors) {
    constexpr double kDegrees = 180 / M_PI;
    Summary::Figures figures;
    for (const auto& sensor : sensors) {
        if (sensor.matches == 0) continue;
        const auto put = [&](const char* name, double value) {
            figures.emplace_back(sensor.label + " " + name, value);
        };
        const auto pose = toMrpt(sensor.pose);
        const Vector6& sigma = sensor.sigma;
        put("x_m", pose.x());
        put("y_m", pose.y());
        put("z_m", pose.z());
        put("yaw_deg", kDegrees * pose.yaw());
        put("pitch_deg", kDegrees * pose.pitch());
        put("roll_deg", kDegrees * pose.roll());
        put("sigma_x_m", sigma[0]);
        put("sigma_y_m", sigma[1]);
        put("sigma_z_m", sigma[2]);
        put("sigma_about_x_deg", kDegrees * sigma[3]);
        put("sigma_about_y_deg", kDegrees * sigma[4]);
        put("sigma_about_z_deg", kDegrees * sigma[5]);
        put("points", static_cast<double>(sensor.matches));
    }
    return figures;
}

std::string wordsOf(const std::vector<std::string>& words) {
    std::string text;
    for (const auto& word : words) text += (text.empty() ? "" : " ") + word;
    return text;
}

/** As yaml-cpp's as(), which asks the locale. */
template <typename Number>
Number numberOf(const YAML::Node& node) {
    const auto number = numberIn<Number>(node.as<std::string>());
    if (!number) throw YAML::TypedBadConversion<Number>(node.Mark());
    return *number;
}

/** Writes fields under their keys. */
struct Writer {
    YAML::Emitter& yaml;

    /** A group of fields that not every summary has; `key`: of one that it always has. */
    bool hasGroup(const char*, bool isThere) const { return isThere; }

    void operator()(const char* key, const std::string& text) const {
        yaml << YAML::Key << key << YAML::Value << YAML::DoubleQuoted << text << YAML::Auto;
    }
    void operator()(const char* key, bool flag) const {
        yaml << YAML::Key << key << YAML::Value << flag;
    }
    /** Counts are written as such: 100000 as a double would be 1e+05, which is no whole number. */
    template <typename Number>
    void operator()(const char* key, Number value) const {
        yaml << YAML::Key << key << YAML::Value << digitsOf(value);
    }
    void operator()(const char* key, const Summary::Figures& figures) const {
        yaml << YAML::Key << key << YAML::Value << YAML::BeginMap;
        for (const auto& [name, value] : figures) (*this)(name.c_str(), value);
        yaml << YAML::EndMap;
    }
    void operator()(const char* key, const std::array<std::size_t, 3>& counts) const {
        yaml << YAML::Key << key << YAML::Value << YAML::Flow << YAML::BeginMap;
        for (std::size_t k = 0; k < 3; ++k) (*this)(std::string(1, "xyz"[k]).c_str(), counts[k]);
        yaml << YAML::EndMap;
    }
    void operator()(const char* key, const std::vector<std::string>& lines) const {
        yaml << YAML::Key << key << YAML::Value;
        if (lines.empty()) yaml << YAML::Flow;
        yaml << YAML::BeginSeq;
        for (const auto& line : lines) yaml << YAML::DoubleQuoted << line;
        yaml << YAML::EndSeq;
    }
};

/** Reads them; a key that is missing is an exception of yaml-cpp. */
struct Reader {
    const YAML::Node& node;

    bool hasGroup(const char* key, bool) const { return static_cast<bool>(node[key]); }

    template <typename Value>
    void operator()(const char* key, Value& value) const {
        const YAML::Node found = node[key];
        if constexpr (std::is_same_v<Value, Summary::Figures>) {
            for (const auto& entry : found)
                value.emplace_back(entry.first.as<std::string>(), numberOf<double>(entry.second));
        } else if constexpr (std::is_same_v<Value, std::array<std::size_t, 3>>) {
            value = {numberOf<std::size_t>(found["x"]), numberOf<std::size_t>(found["y"]),
                     numberOf<std::size_t>(found["z"])};
        } else if constexpr (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>) {
            value = numberOf<Value>(found);
        } else {
            value = found.as<Value>();
        }
    }
};

/** Each field under its key, in the order of the file. `Record`: a Summary, const where it is
 *  written. */
template <typename Record, typename Field>
void forEachField(Record& s, const Field& field) {
    field("version", s.version);
    field("command", s.command);
    field("profile", s.profile);
    field("complete", s.complete);
    if (field.hasGroup("fault", !s.fault.empty())) field("fault", s.fault);
    field("scans", s.scans);
    field("predicted", s.predicted);
    field("longest_predicted", s.longest_predicted);
    field("lost", s.lost);
    field("longest_lost", s.longest_lost);
    field("unlinked", s.unlinked);
    field("tracked", s.tracked);
    field("weakly_observed", s.weakly_observed);
    field("longest_weakly_observed", s.longest_weakly_observed);
    field("weakly_observed_along", s.weakly_observed_along);
    field("weakly_observed_about", s.weakly_observed_about);
    field("searched", s.searched);
    field("longest_searched", s.longest_searched);
    field("interrupted", s.interrupted);
    field("standing", s.standing);
    if (field.hasGroup("loops_closed", s.searched_loops)) {
        field("loop_candidates", s.loop_candidates);
        field("loops_closed", s.loops_closed);
        field("loop_search_ms", s.loop_search_ms);
    }
    if (field.hasGroup("stored_map", !s.stored_map.empty())) {
        field("stored_map", s.stored_map);
        field("in_map", s.in_map);
        field("outside_map", s.outside_map);
        field("not_found_in_map", s.not_found_in_map);
    }
    if (field.hasGroup("imu", !s.imu.empty())) field("imu", s.imu);
    if (field.hasGroup("odometry", !s.odometry.empty())) field("odometry", s.odometry);
    if (field.hasGroup("own_vehicle", !s.own_vehicle.empty())) field("own_vehicle", s.own_vehicle);
    if (field.hasGroup("extrinsics", !s.extrinsics.empty())) field("extrinsics", s.extrinsics);
    if (field.hasGroup("georeference", !s.georeference.empty()))
        field("georeference", s.georeference);
    field("path_m", s.path_m);
    field("vertical_correction_deg", s.vertical_correction_deg);
    field("deskewed", s.deskewed);
    field("ms_per_scan", s.ms_per_scan);
    field("ms_per_scan_of_stages", s.ms_per_scan_of_stages);
    field("latency_ms", s.latency_ms);
    if (field.hasGroup("live", !s.live.empty())) field("live", s.live);
    field("map_ms_per_scan", s.map_ms_per_scan);
    field("optimisation_ms", s.optimisation_ms);
    field("optimisation_iterations", s.optimisation_iterations);
    field("optimisation_cost_before", s.optimisation_cost_before);
    field("optimisation_cost_after", s.optimisation_cost_after);
    field("map_and_pictures_ms", s.map_and_pictures_ms);
    field("peak_rss_mb", s.peak_rss_mb);
    field("warnings", s.warnings);
    if (field.hasGroup("metrics", !s.metrics.empty())) field("metrics", s.metrics);
    if (field.hasGroup("metrics_before_optimisation", !s.metrics_before_optimisation.empty()))
        field("metrics_before_optimisation", s.metrics_before_optimisation);
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

Summary::Figures liveFiguresOf(const LiveRecord& live) {
    auto ms = live.latency_ms;
    if (ms.empty()) ms.push_back(0);
    std::sort(ms.begin(), ms.end());
    return {{"packets", static_cast<double>(live.sensor.packets)},
            {"packets_lost", static_cast<double>(live.sensor.lostPackets)},
            {"packets_not_recorded", static_cast<double>(live.sensor.notRecorded)},
            {"scans_dropped", static_cast<double>(live.sensor.droppedScans)},
            {"latency_median_ms", percentileOf(ms, 50)},
            {"latency_p99_ms", percentileOf(ms, 99)},
            {"latency_worst_ms", ms.back()}};
}

/** Of this program alone: getrusage() counts the one that started it as well. */
double peakMemory_mb() {
    std::ifstream status("/proc/self/status");
    double kilobytes = 0;
    for (std::string word; kilobytes == 0 && status >> word;)
        if (word == "VmHWM:") status >> kilobytes;
    return kilobytes / 1024;
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
    summary.lost = doubts.lost.scans;
    summary.longest_lost = doubts.lost.longest;
    summary.unlinked = unlinkedOf(record).scans;
    summary.tracked = static_cast<std::size_t>(std::count_if(
        record.rows.begin(), record.rows.end(),
        [](const RunRow& row) { return std::string_view("tracked") == stateOf(row); }));
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
    if (record.imu) summary.imu = figuresOf(*record.imu);
    if (record.vertical) put(*record.vertical, summary.imu);
    if (record.wheels) summary.odometry = figuresOf(*record.wheels);
    summary.own_vehicle = figuresOf(record.ownVehicle);
    summary.extrinsics = figuresOf(record.extrinsics);
    summary.deskewed = countOf(record, &RunRow::deskewed);
    summary.georeference = georeferenceOf(record);
    summary.path_m = record.path_m();
    summary.vertical_correction_deg = record.options.scan().vertical_correction_deg;
    summary.ms_per_scan = record.msPerScan();
    summary.latency_ms = latencyOf(record.rows);
    if (record.live) summary.live = liveFiguresOf(*record.live);
    addStages(record, summary);
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

void writeSummary(const Summary& summary, const std::string& path) {
    YAML::Emitter yaml;
    yaml << YAML::BeginMap;
    forEachField(summary, Writer{yaml});
    yaml << YAML::EndMap;
    io::replaceTextFile(path, [&](std::ostream& out) { out << yaml.c_str() << "\n"; });
}

Summary readSummary(const std::string& path) {
    try {
        const YAML::Node node = YAML::LoadFile(path);
        Summary summary;
        forEachField(summary, Reader{node});
        summary.searched_loops = static_cast<bool>(node["loops_closed"]);
        return summary;
    } catch (const std::exception& e) {
        throw Error("cannot parse '" + path + "': " + plainMessage(e));
    }
}
}  // namespace delio::run
