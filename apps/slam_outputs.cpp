#include "slam_outputs.h"

#include <mrpt/containers/yaml.h>
#include <mrpt/core/format.h>
#include <mrpt/system/CTicTac.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <ostream>

#include "cli.h"
#include "delio/error.h"
#include "delio/evaluation/association.h"
#include "delio/evaluation/frame_check.h"
#include "delio/evaluation/kitti_metric.h"
#include "delio/evaluation/rotation_angle.h"
#include "delio/graph/graph_file.h"
#include "delio/io/drive_meta.h"
#include "delio/io/output_file.h"
#include "delio/map/ply.h"
#include "delio/map/scene.h"
#include "delio/map/simplemap.h"
#include "delio/map/snapshot.h"
#include "delio/version.h"

namespace delio {
namespace fs = std::filesystem;
using mrpt::format;
using mrpt::poses::CPose3D;

namespace {
double peakMemory_mb() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

const char* const kFilesOfMap[] = {"map.simplemap", "map.ply", "map.3Dscene", "map.png",
                                   "trajectory.png"};

/** A string as YAML has it: MRPT's writer leaves out the quotes, without which a file's name or a
 *  message may mean something else. */
std::string yamlText(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        const auto code = static_cast<unsigned char>(c);
        result += code < 0x20 ? format("\\x%02X", code) : std::string(1, c);
    }
    return result + "\"";
}

/** Axes that were not observed, each as "x y z". */
std::string axesText(const Eigen::Matrix3Xd& axes) {
    std::string text;
    for (Eigen::Index i = 0; i < axes.cols(); ++i)
        text += format("%s%.3f %.3f %.3f", i > 0 ? "; " : "", axes(0, i), axes(1, i), axes(2, i));
    return text;
}

/** The chain alone is what the odometry's poses were made of: then nothing is optimised. */
bool hasMoreThanTheChain(const graph::PoseGraph& graph) {
    return graph.edges().size() + 1 > graph.poses().size();
}
}  // namespace

SlamRun::SlamRun(std::string folder, std::string profile, std::vector<std::string> command)
    : folder_(std::move(folder)), profile_(std::move(profile)), command_(std::move(command)) {}

std::string SlamRun::path(const std::string& name) const {
    return (fs::path(folder_) / name).string();
}

/** A file of an earlier run (--force) that this one does not write again. */
void SlamRun::forget(const std::string& name) const {
    std::error_code ignored;
    fs::remove(path(name), ignored);
}

void SlamRun::warn(const std::string& text) {
    cli::warn(text);
    warnings_.push_back(text);
}

void SlamRun::readSideFiles(const std::string& rawlog, const std::string& truth,
                            const std::string& truthFrame) {
    const std::string calib = io::sidecarPath(rawlog, ".calib.txt");
    if (fs::exists(calib)) {
        calibration_ = io::readCalibration(calib);
        if (!calibration_.hasTr)
            warn("'" + calib + "' has no Tr: trajectory_kitti_cam0.txt is left out");
    }
    const std::string beside = io::sidecarPath(rawlog, ".poses.txt");
    if (truth.empty() && !fs::exists(beside)) return;
    truthIsCam0_ = truth.empty() || truthFrame == "cam0";
    if (truthIsCam0_ && !calibration_.hasTr) {
        const std::string why = "true poses of cam0 need Tr, and '" + calib + "' has none";
        if (!truth.empty()) throw Error(why + "; give poses of the vehicle instead");
        warn(why + ": no evaluation");
        return;
    }
    truth_ = io::readTrajectory(truth.empty() ? beside : truth);
    truthWasAskedFor_ = !truth.empty();
}

void SlamRun::addScan(const Scan& scan, ScanReport report, double read_ms) {
    if (stampsRise_ && !reports.empty() && scan.stamp_s <= reports.back().stamp_s) {
        stampsRise_ = false;
        warn(format("scan %zu is not later than the one before: trajectory_tum.txt is left out",
                    scan.index));
    }
    report.odometry.features.reset();  // Slam keeps what registration needs
    report.odometry.used = {};
    reports.push_back(std::move(report));
    sensorPoses_.push_back(scan.sensorPose);
    read_ms_.push_back(read_ms);
}

std::string SlamRun::describeLastScan() const {
    const auto& report = reports.back();
    const auto& pose = report.odometry.increment.pose;
    double ms = read_ms_.back() + report.graph_ms;
    for (const double stage : report.odometry.times_ms) ms += stage;
    return format("scan %zu: moved %.3f m, turned %.3f deg, %.0f ms%s%s", report.index, pose.norm(),
                  mrpt::RAD2DEG(evaluation::rotationAngle_rad(pose)), ms,
                  report.odometry.predicted ? ", predicted: " : "", report.odometry.reason.c_str());
}

void SlamRun::optimise(Slam& slam) {
    mrpt::system::CTicTac clock;
    try {
        optimisation_ = slam.optimise();
    } catch (const std::exception& e) {
        // What the odometry found is worth keeping.
        if (fault.empty()) fault = "the pose graph was not optimised: " + plainMessage(e);
    }
    optimise_ms_ = 1e3 * clock.Tac();
}

void SlamRun::write(const Slam& slam, const Options& options, bool withMap) {
    final_ = slam.trajectory();
    if (!stampsRise_) final_.stamps_s.clear();
    const auto& odometry = slam.odometry();
    optimised_ = hasMoreThanTheChain(slam.poseGraph());
    try {
        if (truth_) metrics_ = evaluate(final_);
        if (metrics_ && optimised_) metricsBefore_ = evaluate(odometry);
    } catch (const Error& e) {
        // The drive's results are good all the same.
        if (!truthWasAskedFor_)
            warn(std::string(e.what()) + "; no evaluation");
        else if (fault.empty())
            fault = e.what();
    }
    writeTrajectories(odometry, final_);
    writeGraph(slam.poseGraph());
    writeScans();
    writeConfig(options);
    mrpt::system::CTicTac clock;
    for (const char* name : kFilesOfMap) forget(name);
    try {
        if (withMap) writeMap(slam, final_);
        writePicture(odometry);
    } catch (const Error& e) {
        // A full disk or a missing renderer: the rest of the results is good all the same.
        if (fault.empty()) fault = e.what();
    }
    map_ms_ = 1e3 * clock.Tac();
    writeSummary(options);
}

void SlamRun::optimiseAndWrite(graph::PoseGraph& graph, const Options& options) {
    const io::Trajectory before{graph.poses(), {}};
    mrpt::system::CTicTac clock;
    optimisation_ = graph.optimise(options.graph);
    optimise_ms_ = 1e3 * clock.Tac();
    final_ = {graph.poses(), {}};
    writeTrajectories(before, final_);
    writeGraph(graph);
    writeConfig(options);
    for (const char* name : kFilesOfMap) forget(name);
    forget("scans.csv");
    optimised_ = hasMoreThanTheChain(graph);
    try {
        writePicture(before);
    } catch (const Error& e) {
        fault = e.what();
    }
    writeSummary(options);
}

/** For KITTI the LiDAR is the vehicle; elsewhere the sensor sits somewhere on it. */
io::Trajectory SlamRun::ofSensor(const io::Trajectory& ofVehicle) const {
    io::Trajectory sensor = ofVehicle;
    for (std::size_t i = 0; i < sensor.poses.size(); ++i)
        sensor.poses[i] = (-sensorPoses_[0]) + ofVehicle.poses[i] + sensorPoses_[i];
    return sensor;
}

SlamRun::Metrics SlamRun::evaluate(const io::Trajectory& vehicle) {
    io::Trajectory estimate =
        truthIsCam0_ ? io::lidarToCam0(ofSensor(vehicle), calibration_.Tr) : vehicle;
    io::Trajectory truth = *truth_;
    if (truth.stamps_s.empty()) {
        // Rows of KITTI's poses belong to the scans of the rawlog, of which not all may be used.
        if (reports.back().index >= truth.poses.size())
            throw Error(format("the true poses have %zu rows but scan %zu was used",
                               truth.poses.size(), reports.back().index));
        truth.poses.clear();
        for (const auto& report : reports) truth.poses.push_back(truth_->poses[report.index]);
    }
    const auto pairs = evaluation::associate(truth, estimate);
    if (pairs.reference.size() < 2) throw Error("fewer than two scans have a true pose");
    if (evaluation::findFrameMismatch(pairs.reference, pairs.estimate) !=
        evaluation::FrameMismatch::none)
        throw Error(std::string("the true poses do not look like poses of ") +
                    (truthIsCam0_ ? "cam0" : "the vehicle") +
                    ": their axes are swapped; see --ground-truth-frame");
    const double length = evaluation::pathLength_m(pairs.reference);
    auto lengths = evaluation::kittiLengths_m();
    if (length < 2 * lengths.front()) lengths = evaluation::suggestedLengths_m(length);
    Metrics metrics;
    metrics.row = evaluation::score(pairs.reference, pairs.estimate, lengths, 1);
    metrics.perScan = evaluation::relativeError(pairs.reference, pairs.estimate);
    const CPose3D trueEnd = pairs.reference.back() - pairs.reference.front();
    const CPose3D end = pairs.estimate.back() - pairs.estimate.front();
    metrics.end_m = (trueEnd - end).norm();
    truthInPicture_.clear();
    for (const auto& pose : pairs.reference) {
        const CPose3D moved = pose - pairs.reference.front();
        truthInPicture_.push_back(truthIsCam0_ ? (-calibration_.Tr) + moved + calibration_.Tr
                                               : moved);
    }
    return metrics;
}

void SlamRun::writeTrajectories(const io::Trajectory& odometry, const io::Trajectory& final) {
    io::writeKitti(final, path("trajectory_kitti.txt"));
    io::writeKitti(odometry, path("trajectory_odometry_kitti.txt"));
    forget("trajectory_tum.txt");
    if (!final.stamps_s.empty()) io::writeTum(final, path("trajectory_tum.txt"));
    forget("trajectory_kitti_cam0.txt");
    if (calibration_.hasTr)
        io::writeKitti(io::lidarToCam0(ofSensor(final), calibration_.Tr),
                       path("trajectory_kitti_cam0.txt"));
}

void SlamRun::writeGraph(const graph::PoseGraph& graph) {
    graph::saveG2o(graph, path("posegraph.g2o"));
    graph::saveMrptText(graph, path("posegraph.graph"));
}

void SlamRun::writeMap(const Slam& slam, const io::Trajectory& final) {
    const auto& builder = slam.mapBuilder();
    map::saveSimplemap(builder.simplemap(final.poses), path("map.simplemap"));
    const auto points = builder.points(final.poses);
    map::savePly(points, path("map.ply"));
    const auto scene =
        map::mapScene(points, {final.poses, truthInPicture_, builder.keyPoses(final.poses)});
    map::saveScene(*scene, path("map.3Dscene"));
    map::savePicture(*scene, map::SnapshotOptions(), path("map.png"));
}

/** The trajectory from above; where the graph had something to optimise, before and after it side
 *  by side. */
void SlamRun::writePicture(const io::Trajectory& before) const {
    auto view = map::topView();
    const auto pictureOf = [&](const io::Trajectory& trajectory, const char* name) {
        return map::picture(*map::trajectoryScene(trajectory.poses, truthInPicture_, name), view);
    };
    mrpt::img::CImage sheet;
    if (optimised_) {
        const auto width = static_cast<int>(view.width_px),
                   height = static_cast<int>(view.height_px);
        sheet.resize(2 * width, height, mrpt::img::CH_RGB);
        sheet.drawImage(0, 0, pictureOf(before, "unoptimised"));
        sheet.drawImage(width, 0, pictureOf(final_, "optimised"));
    } else
        sheet = pictureOf(final_, "estimate");
    map::savePng(sheet, path("trajectory.png"));
}

void SlamRun::writeScans() const {
    io::replaceTextFile(path("scans.csv"), [&](std::ostream& out) {
        out << "scan,stamp_s,points,not_finite,read_ms";
        for (const char* stage : kStageNames) out << "," << stage << "_ms";
        out << ",graph_ms,moving,normals,pattern,modes,lines,matches,residual_m,rotation_"
               "observability_1,"
               "rotation_observability_2,rotation_observability_3,translation_observability_1,"
               "translation_observability_2,translation_observability_3,rotation_unobserved,"
               "translation_unobserved,predicted,reason\n";
        for (std::size_t i = 0; i < reports.size(); ++i) {
            const auto& report = reports[i];
            const auto& counts = report.odometry.counts;
            const auto& rotation = report.odometry.registration.rotation;
            const auto& translation = report.odometry.registration.translation;
            out << report.index << format(",%.7f,", report.stamp_s) << counts.points << ","
                << counts.notFinite << format(",%.3f", read_ms_[i]);
            for (const double ms : report.odometry.times_ms) out << format(",%.3f", ms);
            out << format(",%.3f,", report.graph_ms) << counts.moving << "," << counts.normals
                << "," << counts.pattern << "," << counts.modes << "," << counts.lines << ","
                << translation.matches << format(",%.9g", translation.residual_m);
            for (int k = 0; k < 3; ++k) out << format(",%.9g", rotation.observability[k]);
            for (int k = 0; k < 3; ++k) out << format(",%.9g", translation.observability[k]);
            out << "," << axesText(rotation.unobservedAxes) << ","
                << axesText(translation.unobservedAxes) << "," << report.odometry.predicted << ","
                << report.odometry.reason << "\n";
        }
    });
}

void SlamRun::writeConfig(const Options& options) const {
    io::replaceTextFile(path("config.ini"), [&](std::ostream& out) { options.write(out); });
}

mrpt::containers::yaml SlamRun::yamlOf(const Metrics& metrics) {
    mrpt::containers::yaml result = mrpt::containers::yaml::Map();
    const auto put = [&](const char* name, double value) {
        if (std::isfinite(value)) result[name] = value;  // what a short drive cannot tell
    };
    const auto& row = metrics.row;
    put("length_m", row.length_m);
    result["segments"] = row.kitti.segments;
    put("t_percent", row.kitti.t_percent);
    put("r_deg_per_100m", row.kitti.r_deg_per_100m);
    put("ape_m", row.ape_m);
    put("end_error_m", metrics.end_m);
    put("end_error_percent", 100 * metrics.end_m / row.length_m);
    put("scan_translation_median_m", metrics.perScan.translation_m.median);
    put("scan_translation_p95_m", metrics.perScan.translation_m.p95);
    put("scan_rotation_median_deg", metrics.perScan.rotation_deg.median);
    put("scan_rotation_p95_deg", metrics.perScan.rotation_deg.p95);
    return result;
}

std::size_t SlamRun::predictedScans() const {
    return static_cast<std::size_t>(std::count_if(
        reports.begin(), reports.end(), [](const auto& r) { return r.odometry.predicted; }));
}

double SlamRun::msPerScan() const {
    double sum = 0;
    for (std::size_t i = 0; i < reports.size(); ++i) {
        sum += read_ms_[i] + reports[i].graph_ms;
        for (const double ms : reports[i].odometry.times_ms) sum += ms;
    }
    return reports.empty() ? 0 : sum / static_cast<double>(reports.size());
}

double SlamRun::path_m() const { return evaluation::pathLength_m(final_.poses); }

void SlamRun::writeSummary(const Options& options) const {
    using mrpt::containers::yaml;
    const auto scans = static_cast<double>(std::max<std::size_t>(reports.size(), 1));
    yaml summary = yaml::Map();
    summary["version"] = yamlText(kVersion);
    std::string command;
    for (const auto& word : command_) command += (command.empty() ? "" : " ") + word;
    summary["command"] = yamlText(command);
    summary["profile"] = yamlText(profile_);
    summary["complete"] = complete;
    if (!fault.empty()) summary["fault"] = yamlText(fault);
    summary["scans"] = reports.empty() ? final_.poses.size() : reports.size();
    summary["predicted"] = predictedScans();
    summary["path_m"] = path_m();
    summary["vertical_correction_deg"] = options.odometry.preprocess.vertical_correction_deg;
    summary["deskewed"] = std::count_if(reports.begin(), reports.end(),
                                        [](const auto& r) { return r.odometry.deskewed; });
    summary["ms_per_scan"] = msPerScan();
    yaml stages = yaml::Map();
    double read = 0, graph = 0, map = 0;
    StageTimes sums{};
    for (std::size_t i = 0; i < reports.size(); ++i) {
        read += read_ms_[i];
        graph += reports[i].graph_ms;
        map += reports[i].map_ms;
        for (std::size_t k = 0; k < kStages; ++k) sums[k] += reports[i].odometry.times_ms[k];
    }
    stages["read"] = read / scans;
    for (std::size_t k = 0; k < kStages; ++k) stages[kStageNames[k]] = sums[k] / scans;
    stages["graph"] = graph / scans;
    summary["ms_per_scan_of_stages"] = stages;
    summary["map_ms_per_scan"] = map / scans;
    summary["optimisation_ms"] = optimise_ms_;
    summary["optimisation_iterations"] = optimisation_.iterations;
    summary["optimisation_cost_before"] = optimisation_.initial_cost;
    summary["optimisation_cost_after"] = optimisation_.final_cost;
    summary["map_and_pictures_ms"] = map_ms_;
    summary["peak_rss_mb"] = peakMemory_mb();
    yaml warnings = yaml::Sequence();
    // Otherwise an empty list is printed as nothing, which is no YAML that MRPT reads.
    warnings.node().printInShortFormat = warnings_.empty();
    for (const auto& warning : warnings_) warnings.push_back(yamlText(warning));
    summary["warnings"] = warnings;
    if (metrics_) summary["metrics"] = yamlOf(*metrics_);
    if (metricsBefore_) summary["metrics_before_optimisation"] = yamlOf(*metricsBefore_);
    io::replaceTextFile(path("summary.yaml"), [&](std::ostream& out) {
        summary.printAsYAML(out);
        out << "\n";
    });
}

std::vector<std::pair<std::string, std::string>> SlamRun::rowsOf(const Metrics& m) {
    std::vector<std::pair<std::string, std::string>> rows;
    if (m.row.kitti.segments > 0) {
        const auto& lengths = m.row.kitti.perLength;
        rows.emplace_back("KITTI segments",
                          format("%zu of %g to %g m", m.row.kitti.segments,
                                 lengths.front().length_m, lengths.back().length_m));
        rows.emplace_back("KITTI translation", format("%.3f %%", m.row.kitti.t_percent));
        rows.emplace_back("KITTI rotation", format("%.3f deg/100 m", m.row.kitti.r_deg_per_100m));
    }
    const std::string share =
        m.row.length_m > 0 ? format(", %.2f %%", 100 * m.end_m / m.row.length_m) : "";
    rows.emplace_back("end error",
                      format("%.3f m%s of %.1f m", m.end_m, share.c_str(), m.row.length_m));
    rows.emplace_back("APE (aligned)", format("%.3f m", m.row.ape_m));
    rows.emplace_back("translation per scan",
                      format("%.4f m median, %.4f m 95 %%", m.perScan.translation_m.median,
                             m.perScan.translation_m.p95));
    rows.emplace_back("rotation per scan",
                      format("%.4f deg median, %.4f deg 95 %%", m.perScan.rotation_deg.median,
                             m.perScan.rotation_deg.p95));
    return rows;
}

void SlamRun::printTable(std::ostream& out) const {
    const auto row = [&](const char* name, const std::string& value) {
        out << format("%-26s %s\n", name, value.c_str());
    };
    row("scans", std::to_string(reports.size()));
    row("predicted", std::to_string(predictedScans()));
    row("path", format("%.1f m", path_m()));
    row("time per scan", format("%.1f ms", msPerScan()));
    row("peak memory", format("%.0f MB", peakMemory_mb()));
    if (metrics_) {
        const auto values = rowsOf(*metrics_);
        const auto before = metricsBefore_ ? rowsOf(*metricsBefore_) : values;
        if (metricsBefore_) out << format("%-26s %-34s %s\n", "", "optimised", "unoptimised");
        for (std::size_t i = 0; i < values.size(); ++i)
            if (metricsBefore_)
                out << format("%-26s %-34s %s\n", values[i].first.c_str(), values[i].second.c_str(),
                              before[i].second.c_str());
            else
                row(values[i].first.c_str(), values[i].second);
    }
    row("results", folder_);
}
}  // namespace delio
