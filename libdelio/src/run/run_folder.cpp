#include "delio/run/run_folder.h"

#include <filesystem>
#include <fstream>
#include <ostream>
#include <sstream>

#include "delio/core/error.h"
#include "delio/core/stopwatch.h"
#include "delio/files/output.h"
#include "delio/formats/g2o.h"
#include "delio/formats/georeference.h"
#include "delio/map/cloud_files.h"
#include "delio/map/page.h"
#include "delio/map/simplemap.h"
#include "mrpt/interpolator.h"
#include "recordings/extrinsics.h"
#include "run/tables.h"

namespace delio::run {
namespace fs = std::filesystem;

namespace {
/** The one that marks the whole first. */
constexpr const char* kAll[] = {RunFolder::kSummary,
                                RunFolder::kDrives,
                                RunFolder::kTrajectory,
                                RunFolder::kOdometry,
                                RunFolder::kCam0,
                                RunFolder::kOdometryCam0,
                                RunFolder::kTum,
                                RunFolder::kInterpolator,
                                RunFolder::kGeoreference,
                                RunFolder::kGeoTrajectory,
                                RunFolder::kEnuTum,
                                RunFolder::kGeoJson,
                                RunFolder::kCloudTum,
                                RunFolder::kGraph,
                                RunFolder::kMrptGraph,
                                RunFolder::kScans,
                                RunFolder::kLoops,
                                RunFolder::kLocalisation,
                                RunFolder::kJoints,
                                RunFolder::kExtrinsics,
                                RunFolder::kConfig,
                                RunFolder::kSimplemap,
                                RunFolder::kPly,
                                RunFolder::kDynamicPly,
                                RunFolder::kMapPage,
                                RunFolder::kStoredMap,
                                RunFolder::kScene,
                                RunFolder::kMapPicture,
                                RunFolder::kRemovalPicture,
                                RunFolder::kTrajectoryPicture};

void writeScans(const std::vector<RunRow>& rows, const std::string& path) {
    io::writeScanTable(
        rows.size(), [&](std::size_t i) { return scanRowOf(rows[i]); }, path);
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
    if (record.georeference) page.north = record.georeference->north();
    return page;
}
void writeOnEarth(const RunRecord& record, const RunFolder& folder) {
    const auto& place = *record.georeference;
    io::writeGeoreference(place, record.gnss, folder.path(RunFolder::kGeoreference));
    io::writeGeoTrajectory(record.final, place, folder.path(RunFolder::kGeoTrajectory));
    io::writeGeoJson(record.final, place, record.drive, folder.path(RunFolder::kGeoJson));
    if (record.final.stamps_s.empty()) return;
    auto enu = record.final;
    for (auto& pose : enu.poses) pose = place.enuFromMap * pose;
    io::writeTum(enu, folder.path(RunFolder::kEnuTum));
}

/** Not where it would be the same as kTum. */
void writeInCloud(const RunRecord& record, const RunFolder& folder) {
    const Eigen::Vector3d& offset = record.cloudOrigin->offset;
    if (offset.isZero()) return;
    auto inCloud = record.final;
    for (auto& pose : inCloud.poses) pose.translation() += offset;
    io::writeTum(inCloud, folder.path(RunFolder::kCloudTum));
}
/** What was calibrated in the drive, for --extrinsics; empty: nothing. */
std::string extrinsicsOf(const RunRecord& record) {
    std::string lines;
    for (const auto& sensor : record.extrinsics)
        lines += io::extrinsicsLine(sensor.label, sensor.pose) + "\n";
    const auto& imu = record.imu;
    if (imu && imu->rotation && imu->rotationSigma_rad) {
        io::ImuMount mount;
        mount.pose.linear() = record.rows.front().sensorPose.linear() * *imu->rotation;
        if (imu->offsetSigma_s) mount.offset_s = imu->offset_s;
        lines += io::extrinsicsLine(mount) + "\n";
    }
    if (lines.empty()) return lines;
    return "# LABEL x y z yaw pitch roll (metres and degrees, in the vehicle)\n" + lines;
}
}  // namespace

std::string storedMapIn(const std::string& path) {
    if (!fs::is_directory(path)) return path;
    const RunFolder folder(path);
    if (folder.has(RunFolder::kStoredMap)) return folder.path(RunFolder::kStoredMap);
    throw Error("'" + path + "' contains no " + RunFolder::kStoredMap +
                "; give the folder of a finished delio-slam run (without --no-map)");
}

std::string RunFolder::path(const char* name) const { return (fs::path(folder_) / name).string(); }

bool RunFolder::has(const char* name) const { return fs::exists(path(name)); }

std::vector<std::string> RunFolder::files() const {
    std::vector<std::string> files;
    for (const char* name : kAll) files.push_back(path(name));
    return files;
}

std::vector<LoopRow> RunFolder::loops() const { return readLoopTable(path(kLoops)); }

std::vector<LoopRow> RunFolder::joints() const { return readLoopTable(path(kJoints)); }

std::vector<LocalisationRow> RunFolder::localisation() const {
    return readLocalisationTable(path(kLocalisation));
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
    if (!record.final.stamps_s.empty()) {
        io::writeTum(record.final, path(kTum));
        io::writeInterpolator(record.final, record.epoch_s, path(kInterpolator));
    }
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
        map.simplemap.clear();  // and what scans say of places: pictures want the memory
        map::savePly(map.points, path(kPly));
        if (maps.keepDynamic) map::savePly(map.dynamic, path(kDynamicPly));
        map::savePage(pageOf(record, map), path(kMapPage));
    }
    if (illustrate) illustrate(record, map, *this);
}

void RunFolder::writeTables(const RunRecord& record) const {
    writeTrajectories(record);
    if (record.georeference) writeOnEarth(record, *this);
    if (record.cloudOrigin && !record.final.stamps_s.empty()) writeInCloud(record, *this);
    io::saveG2o(record.graph, path(kGraph));
    io::saveMrptText(record.graph, path(kMrptGraph), record.closedLoops());
    if (!record.rows.empty()) writeScans(record.rows, path(kScans));
    if (record.searchedLoops) writeLoopTable(record.loops, path(kLoops));
    if (!record.joints.empty()) writeLoopTable(record.joints, path(kJoints));
    if (!record.fixes.empty())
        writeLocalisationTable(record.rows, record.fixes, path(kLocalisation));
    const auto extrinsics = extrinsicsOf(record);
    if (!extrinsics.empty())
        io::replaceTextFile(path(kExtrinsics), [&](std::ostream& out) { out << extrinsics; });
    io::replaceTextFile(path(kConfig), [&](std::ostream& out) { record.options.write(out); });
}

std::string RunFolder::write(RunRecord record, const RunMaps& maps,
                             const Illustrate& illustrate) const {
    std::error_code fault;
    fs::create_directories(folder_, fault);
    if (fault) throw Error("cannot create the folder '" + folder_ + "': " + fault.message());
    // What a kill leaves lies with the rest of the run that was killed, if there is a place.
    const std::string incomplete = path(kIncomplete);
    io::PartialFolder partial(folder_, folder_,
                              fs::is_directory(incomplete, fault) ? incomplete : "");
    try {
        const RunFolder results(partial.path().string());
        results.writeTables(record);
        Stopwatch watch;
        try {
            results.writeMaps(record, maps, illustrate);
        } catch (const std::exception& e) {
            // A full disk, too little memory, no renderer: the rest of the results is good all the
            // same.
            if (record.fault.empty()) record.fault = partial.asInPlace(plainMessage(e));
        }
        writeSummary(summaryOf(record, watch.lap_ms()), results.path(kSummary));
        // Power that fails now must not leave names without what is in the files.
        for (const char* name : kAll)
            if (results.has(name)) io::putOnDisk(results.path(name));
        partial.putInPlace({std::begin(kAll), std::end(kAll)});
        io::putOnDisk(folder_);
        return record.fault;
    } catch (const Error& e) {
        throw Error(partial.asInPlace(e.what()));
    }
}
}  // namespace delio::run
