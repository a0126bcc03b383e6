#include "delio/run/run_folder.h"

#include <mrpt/core/format.h>

#include <filesystem>
#include <fstream>
#include <ostream>
#include <sstream>

#include "delio/core/error.h"
#include "delio/core/stopwatch.h"
#include "delio/io/g2o.h"
#include "delio/io/output_file.h"
#include "delio/map/page.h"
#include "delio/map/ply.h"
#include "delio/map/simplemap.h"

namespace delio::run {
namespace fs = std::filesystem;
using mrpt::format;

namespace {
/** Axes that were not observed, each as "x y z". */
std::string axesText(const Eigen::Matrix3Xd& axes) {
    std::string text;
    for (Eigen::Index i = 0; i < axes.cols(); ++i)
        text += format("%s%.3f %.3f %.3f", i > 0 ? "; " : "", axes(0, i), axes(1, i), axes(2, i));
    return text;
}

io::ScanRow rowOf(const RunRow& row) {
    const Step& step = row.report.step;
    io::ScanRow cells{row.scan, row.stamp_s, {}, step.predicted, step.reason};
    const auto put = [&](const std::string& name, const std::string& value) {
        cells.values.emplace_back(name, value);
    };
    put("points", std::to_string(row.points));
    put("not_finite", std::to_string(step.notFinite));
    put("read_ms", format("%.3f", row.read_ms));
    for (const auto& [stage, ms] : step.times_ms)
        put(std::string(stage) + "_ms", format("%.3f", ms));
    for (const auto& [listener, ms] : row.report.listeners_ms)
        put(std::string(listener) + "_ms", format("%.3f", ms));
    for (const auto& [name, value] : step.details) put(name, format("%.9g", value));
    const Quality& quality = step.quality;
    put("matches", std::to_string(quality.matches));
    put("residual_m", format("%.9g", quality.residual_m));
    for (int k = 0; k < 3; ++k)
        put(format("rotation_observability_%d", k + 1),
            format("%.9g", quality.rotationObservability[k]));
    for (int k = 0; k < 3; ++k)
        put(format("translation_observability_%d", k + 1),
            format("%.9g", quality.translationObservability[k]));
    put("rotation_unobserved", axesText(quality.unobservedRotation));
    put("translation_unobserved", axesText(quality.unobservedTranslation));
    put("searched", step.searched ? "1" : "0");
    put("interrupted", step.interrupted ? "1" : "0");
    return cells;
}

void writeScans(const std::vector<RunRow>& rows, const std::string& path) {
    std::vector<io::ScanRow> table;
    table.reserve(rows.size());
    for (const auto& row : rows) table.push_back(rowOf(row));
    io::writeScanTable(table, path);
}

map::PageContent pageOf(const RunRecord& record, const map::BuiltMap& map) {
    map::PageContent page;
    page.title = record.drive;
    page.points = map.points;
    page.dynamic = map.dynamic;
    page.trajectory = record.final.poses;
    page.loops = record.closedLoops();
    page.truth = record.truth;
    if (record.optimised()) page.odometry = record.odometry.poses;
    return page;
}
}  // namespace

std::string storedMapIn(const std::string& path) {
    if (!fs::is_directory(path)) return path;
    const RunFolder folder(path);
    if (folder.has(RunFolder::kStoredMap)) return folder.path(RunFolder::kStoredMap);
    throw Error("'" + path + "' holds no " + RunFolder::kStoredMap +
                ": is it the folder of a delio-slam run (without --no-map) that has ended?");
}

std::string RunFolder::path(const char* name) const { return (fs::path(folder_) / name).string(); }

bool RunFolder::has(const char* name) const { return fs::exists(path(name)); }

/** A file of an earlier run that this one does not write again. */
void RunFolder::remove(const char* name) const {
    std::error_code ignored;
    fs::remove(path(name), ignored);
}

graph::PoseGraph RunFolder::graph() const { return io::loadG2o(path(kGraph)); }

Options RunFolder::options() const {
    std::ifstream in(path(kConfig), std::ios::binary);
    if (!in) throw Error("cannot read '" + path(kConfig) + "': no such file, or not readable");
    std::ostringstream text;
    text << in.rdbuf();
    Options options;
    options.load(text.str());
    return options;
}

void RunFolder::writeTrajectories(const RunRecord& record) const {
    io::writeKitti(record.final, path(kTrajectory));
    io::writeKitti(record.odometry, path(kOdometry));
    remove(kTum);
    if (!record.final.stamps_s.empty()) io::writeTum(record.final, path(kTum));
    remove(kCam0);
    remove(kOdometryCam0);
    if (!record.calibration.hasTr || record.rows.empty()) return;
    const auto inCam0 = [&](const io::Trajectory& vehicle) {
        return io::lidarToCam0(ofSensor(vehicle, record.rows), record.calibration.Tr);
    };
    io::writeKitti(inCam0(record.final), path(kCam0));
    if (record.optimised()) io::writeKitti(inCam0(record.odometry), path(kOdometryCam0));
}

void RunFolder::writeMaps(const RunRecord& record, const RunMaps& maps,
                          const Illustrate& illustrate) const {
    if (maps.stored) StoredMap::save(*maps.stored, path(kStoredMap));
    map::BuiltMap map;
    if (maps.points) {
        map = maps.points->build(record.final.poses);
        map::saveSimplemap(map.simplemap, path(kSimplemap));
        map::savePly(map.points, path(kPly));
        if (maps.keepDynamic) map::savePly(map.dynamic, path(kDynamicPly));
        map::savePage(pageOf(record, map), path(kMapPage));
    }
    if (illustrate) illustrate(record, map, *this);
}

std::string RunFolder::write(RunRecord record, const RunMaps& maps,
                             const Illustrate& illustrate) const {
    std::error_code fault;
    fs::create_directories(folder_, fault);
    if (fault) throw Error("cannot make the folder '" + folder_ + "': " + fault.message());
    remove(kSummary);
    writeTrajectories(record);
    io::saveG2o(record.graph, path(kGraph));
    io::saveMrptText(record.graph, path(kMrptGraph), record.closedLoops());
    remove(kScans);
    if (!record.rows.empty()) writeScans(record.rows, path(kScans));
    remove(kLoops);
    if (record.searchedLoops) writeLoopTable(record.loops, path(kLoops));
    remove(kJoints);
    if (!record.joints.empty()) writeLoopTable(record.joints, path(kJoints));
    remove(kLocalisation);
    if (!record.fixes.empty())
        writeLocalisationTable(record.rows, record.fixes, path(kLocalisation));
    io::replaceTextFile(path(kConfig), [&](std::ostream& out) { record.options.write(out); });
    Stopwatch watch;
    for (const char* name : {kStoredMap, kSimplemap, kPly, kDynamicPly, kMapPage, kScene,
                             kMapPicture, kRemovalPicture, kTrajectoryPicture})
        remove(name);
    try {
        writeMaps(record, maps, illustrate);
    } catch (const Error& e) {
        // A full disk or a missing renderer: the rest of the results is good all the same.
        if (record.fault.empty()) record.fault = e.what();
    }
    writeSummary(summaryOf(record, watch.lap_ms()), path(kSummary));
    return record.fault;
}
}  // namespace delio::run
