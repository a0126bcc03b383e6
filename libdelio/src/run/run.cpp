#include "delio/run/run.h"

#include <mrpt/core/format.h>

#include <cmath>
#include <limits>

#include "delio/core/error.h"
#include "delio/core/stopwatch.h"
#include "delio/formats/drive_meta.h"
#include "delio/mrpt/rawlog_writer.h"
#include "delio/run/doubts.h"
#include "delio/run/run_folder.h"
#include "odometry/preprocess.h"
#include "places/join_maps.h"
#include "places/tiles.h"
#include "places/update_map.h"
#include "run/tables.h"
#include "slam/georeferencing.h"
#include "slam/levelling.h"
#include "slam/place_listeners.h"
#include "slam/specific_force.h"

namespace delio::run {
namespace {
graph::PoseGraphOptions graphOptions(const Options& options, const RunSettings& settings) {
    auto graph = options.graph;
    if (!settings.graph) graph.skip_edges = graph.window = 0;
    return graph;
}
}  // namespace

Run::Run(const Options& options, const RunSettings& settings)
    : settings_(settings),
      slam_(makeOdometry(options)),
      graph_(std::make_shared<GraphBuilder>(graphOptions(options, settings))),
      forces_(std::make_unique<SpecificForce>()) {
    options.check();
    if (settings.update && !options.map.removal.enabled)
        throw Error("--update needs removal.enabled=true: it looks for what scans saw through");
    record_.profile = settings.profile;
    record_.command = settings.command;
    record_.drive = settings.drive;
    record_.options = options;
    attach(graph_);
    std::string temporary;
    if (!settings.folder.empty()) {
        temporary = RunFolder(settings.folder).path(RunFolder::kIncomplete);
        rows_ = std::make_unique<RowFiles>(temporary);
    }
    if (!settings.storedMap.empty()) {
        record_.storedMap =
            settings.storedMapName.empty() ? settings.storedMap : settings.storedMapName;
        follower_ = std::make_shared<MapFollower>(
            MapTracker(std::make_shared<const StoredMap>(storedMapIn(settings.storedMap)),
                       options.placeSearch, options.localisation));
        if (settings.initialPose) follower_->expect(*settings.initialPose);
        attach(follower_);
    }
    if (searchesLoops() || settings.map) {
        loops_ = std::make_shared<LoopCloser>(options.submaps, loopOptions(), options.closures,
                                              temporary);
        attach(loops_);
    }
    if (!settings.map) return;
    map_ = std::make_shared<MapListener>(
        map::MapBuilder(options.map, settings.sensorLabel, temporary));
    attach(map_);
}

Run::~Run() = default;

bool Run::searchesLoops() const {
    return settings_.loops && settings_.graph && record_.options.loops.enabled;
}

/** Where no loops are wanted, no path is long enough to lead back. */
places::LoopOptions Run::loopOptions() const {
    auto loops = record_.options.loops;
    if (!searchesLoops()) loops.min_path = std::numeric_limits<double>::infinity();
    return loops;
}

void Run::warn(const std::string& text) {
    record_.warnings.push_back(text);
    if (settings_.onWarning) settings_.onWarning(text);
}

void Run::add(std::vector<CalibratedSensor> extrinsics) {
    for (const auto& sensor : extrinsics) {
        std::string kept;
        for (const auto& axis : sensor.unobserved) kept += (kept.empty() ? "" : ", ") + axis;
        if (!sensor.reason.empty())
            warn("the pose of the sensor '" + sensor.label + "' was not refined: " + sensor.reason);
        else if (!kept.empty())
            warn("the pose of the sensor '" + sensor.label + "' was not refined " + kept +
                 ": the drive does not show it");
    }
    record_.extrinsics = std::move(extrinsics);
}

void Run::fail(const std::string& fault) {
    if (record_.fault.empty()) record_.fault = fault;
}

void Run::readSideFiles(const std::string& recording, const std::string& truth, bool truthIsCam0) {
    readSideFiles(io::sideFile(io::sidecarPath(recording, ".calib.txt")),
                  io::sideFile(io::sidecarPath(recording, ".poses.txt")), truth, truthIsCam0);
}

void Run::readSideFiles(const io::SideFile& calib, const io::SideFile& poses,
                        const std::string& truth, bool truthIsCam0) {
    if (!calib.text.empty()) {
        record_.calibration = io::calibrationIn(calib.text, calib.name);
        if (!record_.calibration.hasTr)
            warn("'" + calib.name + "' has no Tr: trajectory_kitti_cam0.txt is not written");
    }
    if (truth.empty() && poses.text.empty()) return;
    truthIsCam0_ = truth.empty() || truthIsCam0;
    if (truthIsCam0_ && !record_.calibration.hasTr) {
        const std::string why =
            "ground truth in the cam0 frame needs Tr, but " +
            (calib.name.empty() ? "there is no calib.txt" : "'" + calib.name + "' has no Tr");
        if (!truth.empty())
            throw Error(why + "; give vehicle poses instead (--ground-truth-frame vehicle)");
        warn(why + ": no evaluation");
        return;
    }
    truth_ = truth.empty() ? io::trajectoryIn(poses.text, poses.name) : io::readTrajectory(truth);
    truthWasAskedFor_ = !truth.empty();
}

void Run::addImu(const ImuSample& sample) {
    slam_.addImu(sample);
    forces_->add(sample);
}

RunRow Run::process(const Scan& scan, double read_ms) {
    const auto report = slam_.process(scan);
    const auto imu = slam_.imuReport();
    forces_->addScan(scan.stamp_s + (imu ? imu->offset_s : 0),
                     imu ? imu->bias_radps : Eigen::Vector3d::Zero());
    for (const auto& failed : report.failed) switchOff(failed, scan.index);
    auto& rows = record_.rows;
    if (rows.empty()) record_.epoch_s = mrpt::Clock::toDouble(scan.time) - scan.stamp_s;
    auto row = rowOf(scan, report, read_ms, rows.empty() ? nullptr : &rows.back());
    if (row.points == 0 && !row.reason.empty()) {
        const auto why = odometry::whyNoneIsLeft(scan, record_.options.scan());
        if (!why.empty()) row.reason = why;
    }
    if (record_.stampsRise && !rows.empty() && scan.stamp_s <= rows.back().stamp_s) {
        record_.stampsRise = false;
        warn(mrpt::format(
            "scan %zu is not later than the previous one: trajectory_tum.txt is not written",
            scan.index));
    }
    for (const auto& corrected : report.step.corrected)
        if (corrected.registered) rows.at(rows.size() - corrected.scansAgo).lost = false;
    rows.push_back(row);
    try {
        if (rows_) rows_->add(row, slam_.trajectory().poses.back());
    } catch (const std::exception& e) {
        warn("intermediate results cannot be written: " + plainMessage(e));
    }
    return row;
}

Run::Pose Run::latestPose() const {
    const auto& odometry = slam_.trajectory();
    const Pose own{odometry.stamps_s.back(), odometry.poses.back(), false};
    if (!follower_ || follower_->fixes().empty()) return own;
    const MapFix& fix = follower_->fixes().back();
    if (fix.where == Whereabouts::kUnknown) return own;
    return {own.stamp_s, fix.vehicle.pose, true};
}

/** The results of a failed listener are not written. */
void Run::switchOff(const FailedListener& failed, std::size_t scan) {
    const std::string what = std::string("the listener '") + failed.listener->name() +
                             "' failed at scan " + std::to_string(scan) +
                             " and its results are missing: " + failed.message;
    if (record_.fault.empty())
        fail(what);
    else
        warn(what);
    const auto drop = [&](auto& listener) {
        if (listener == failed.listener) listener.reset();
    };
    drop(graph_);
    drop(map_);
    drop(follower_);
    drop(loops_);
}

/** Without loops the graph is unchanged. */
void Run::closeLoops() {
    auto closed = loops_->close(record_.graph, graphOptions(record_.options, settings_));
    record_.searchedLoops = searchesLoops();
    record_.loop_search_ms = loops_->search_ms();
    record_.loops = std::move(closed.candidates);
    if (closed.accepted == 0) return;
    record_.graph = std::move(closed.graph);
    record_.optimisation = closed.optimisation;
}

/** Into the stored map's frame, held by every scan that was measured there. */
void Run::anchor() {
    record_.fixes = follower_->fixes();
    if (!record_.isLocalised()) {
        const std::string what = "no scan of the drive could be localised in the map '" +
                                 record_.storedMap +
                                 "': the poses are the odometry's, relative to the first scan";
        return settings_.mayBeElsewhere ? warn(what) : fail(what);
    }
    for (const auto& warning : warningsOf(record_.fixes, record_.rows)) warn(warning);
    record_.graph = anchored(record_.graph, record_.fixes);
    if (settings_.graph) record_.optimisation = record_.graph.optimise(record_.options.graph);
}

/** Loops are closed, the graph is optimised or brought into the stored map's frame. */
void Run::optimiseGraph() {
    record_.graph = graph_->graph();
    try {
        if (loops_) closeLoops();
    } catch (const std::exception& e) {
        fail("loops were not closed: " + plainMessage(e));
    }
    try {
        if (settings_.graph && record_.closedLoops().empty() && !follower_) {
            record_.optimisation = graph_->optimise();
            record_.graph = graph_->graph();
        }
        if (follower_) anchor();
    } catch (const std::exception& e) {
        // What the odometry found is worth keeping.
        fail("pose graph was not optimised: " + plainMessage(e));
    }
}

/** The accelerometer says what is up, where the gyroscope agrees with the scans. */
void Run::level() {
    ForcesOnTrack track{record_.odometry.stamps_s, {}, {}, forces_->take()};
    for (const auto& row : record_.rows) {
        track.usable.push_back(!row.predicted && !row.lost && !row.interrupted);
        track.mounts.push_back(row.sensorPose.linear() * *record_.imu->rotation);
    }
    const bool moves = settings_.graph && graph_ && !record_.isLocalised();
    try {
        auto found = levelled(record_.graph, track, moves ? &record_.options.graph : nullptr);
        record_.vertical = found.vertical;
        record_.graph = std::move(found.graph);
    } catch (const std::exception& e) {
        warn("the map is not levelled: " + plainMessage(e));
    }
}

/** Turns the map so that its z is up; the heading of x stays. */
void Run::standUpright() {
    if (!record_.vertical || !record_.vertical->refusal.empty())
        return warn("the map is not levelled: " +
                    (record_.vertical ? record_.vertical->refusal
                                      : "there is no IMU that agrees with the scans"));
    Eigen::Vector3d& up = record_.vertical->up;
    const Eigen::Isometry3d upright(
        Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ()));
    auto poses = record_.graph.poses();
    for (auto& pose : poses) pose = upright * pose;
    record_.graph = record_.graph.withPoses(poses);
    for (auto& pose : record_.odometry.poses) pose = upright * pose;
    up = Eigen::Vector3d::UnitZ();
}

void Run::add(const earth::Fixes& fixes) {
    gnssFixes_.insert(gnssFixes_.end(), fixes.begin(), fixes.end());
}

/** Fixes move the poses, but those in a stored map. Fixes that do not determine the place of the
 *  map are a warning. */
void Run::georeference() {
    const bool moves = settings_.graph && graph_ && !record_.isLocalised();
    earth::Track track{record_.graph.poses(), record_.odometry.stamps_s, {}};
    for (const auto& row : record_.rows) track.usable.push_back(!row.predicted && !row.lost);
    try {
        auto found = georeferenced(record_.graph, track, gnssFixes_,
                                   moves ? &record_.options.graph : nullptr);
        record_.gnss = found.figures;
        if (!found.figures.refusal.empty())
            return warn("the map is not georeferenced: " + found.figures.refusal);
        record_.georeference = found.place;
        record_.graph = std::move(found.graph);
        if (found.figures.inGraph > 0 && truth_)
            warn(
                "the final poses use GNSS fixes: ground truth of the same receiver flatters them; "
                "--no-gnss leaves the fixes out");
    } catch (const std::exception& e) {
        warn("the map is not georeferenced: " + plainMessage(e));
    }
}

void Run::optimise() {
    Stopwatch watch;
    record_.odometry = slam_.trajectory();
    if (graph_)
        optimiseGraph();
    else  // it failed: nodes without edges
        for (const auto& pose : record_.odometry.poses) record_.graph.addNode(pose);
    if (follower_ && record_.isLocalised()) {
        record_.georeference = follower_->map().georeference();
        record_.cloudOrigin = follower_->map().cloudOrigin();
    }
    if (record_.imu && record_.imu->rotation) level();
    if (settings_.level && !record_.isLocalised()) standUpright();
    if (settings_.gnss && !gnssFixes_.empty() && !record_.georeference) georeference();
    record_.optimise_ms = watch.lap_ms();
    record_.final = {record_.graph.poses(), record_.odometry.stamps_s};
    if (!record_.stampsRise) record_.final.stamps_s.clear();
}

/** The map to come back to: submaps where the final poses put them. */
void Run::store() {
    const auto& submaps = loops_->search();
    own_ = MapContent{record_.graph,
                      {{settings_.drive, 0, record_.odometry.stamps_s}},
                      submaps.submaps(),
                      [&](std::size_t i) { return submaps.descriptor(i); },
                      [&](std::size_t i) { return submaps.points(i); },
                      record_.georeference,
                      {}};
    // A map.delio with this drive alone would look like the updated map.
    if (!settings_.update) stored_ = own_;
    if (!follower_ || !record_.isLocalised()) return;
    try {
        if (settings_.extend) extend();
    } catch (const std::exception& e) {
        fail("the map was not extended: " + plainMessage(e));
    }
    try {
        if (settings_.update) update();
    } catch (const std::exception& e) {
        fail("the map was not updated: " + plainMessage(e));
    }
}

/** Without times where the recording's own begin at 0. */
Visit Run::visit() const {
    constexpr double kFirstUnix_s = 5e8;
    const auto& stamps = record_.odometry.stamps_s;
    const double begin_s = record_.epoch_s + stamps.front();
    const bool isMadeUp = std::abs(record_.epoch_s - io::kDriveEpoch_s) < 1;
    if (isMadeUp || begin_s < kFirstUnix_s) return {settings_.drive};
    return {settings_.drive, begin_s, record_.epoch_s + stamps.back()};
}

void Run::update() {
    if (!map_) throw Error("the scans of the drive could not be put aside");
    std::vector<bool> measured;
    VisitScans scans;
    scans.visit = visit();
    for (std::size_t i = 0; i < record_.fixes.size(); ++i) {
        measured.push_back(isAnchor(record_.fixes[i]));
        if (measured.back()) scans.poses.push_back(record_.final.poses[i]);
    }
    const auto level = places::levelFrames(own_->submaps, record_.final.poses);
    std::vector<Eigen::Matrix3Xf> parts;
    for (std::size_t i = 0; i < level.size(); ++i)
        if (measured[own_->submaps[i].key])
            parts.emplace_back(level[i].cast<float>() * own_->points(i));
    scans.points = places::together(parts);
    scans.seenThrough = [&](const Eigen::Matrix3Xf& points) {
        return map_->builder().seenThrough(points, record_.final.poses, measured);
    };
    auto result = updated(follower_->map(), scans);
    record_.update = result.figures;
    stored_ = std::move(result.content);
}

void Run::extend() {
    auto both = joined(follower_->map(), *own_, record_.fixes, record_.options.loops,
                       record_.options.closures, record_.options.graph);
    record_.joints = std::move(both.joints);
    if (both.accepted == 0)
        return fail(
            "the map was not extended: no submap of the drive was accepted (see joints.csv)");
    record_.extended = true;
    record_.addedSubmaps = both.added;
    stored_ = std::move(both.content);
    stored_->georeference = record_.georeference;
}

evaluation::Comparison Run::compared(const io::Trajectory& vehicle) const {
    io::ScanTable used;
    for (const auto& row : record_.rows) {
        used.scans.push_back(row.scan);
        used.stamps_s.push_back(row.stamp_s);
        used.predicted.push_back(row.predicted);
    }
    const auto estimate =
        truthIsCam0_ ? io::lidarToCam0(ofSensor(vehicle, record_.rows), record_.calibration.Tr)
                     : vehicle;
    try {
        auto found = evaluation::compare(*truth_, estimate, {}, &used);
        if (found.reference.size() < 2) throw Error("fewer than two scans have ground truth");
        return found;
    } catch (const evaluation::WrongFrames&) {
        throw Error(std::string("the ground truth does not look like poses of ") +
                    (truthIsCam0_ ? "cam0" : "the vehicle") +
                    ": the axes are swapped; see --ground-truth-frame");
    }
}

void Run::score() {
    try {
        record_.metrics = compared(record_.final);
        if (record_.optimised()) record_.metricsBefore = compared(record_.odometry);
    } catch (const Error& e) {
        // The drive's results are good all the same.
        if (truthWasAskedFor_)
            fail(e.what());
        else
            warn(std::string(e.what()) + "; no evaluation");
        return;
    }
    if (!record_.metrics->referenceFault.empty()) warn(record_.metrics->referenceFault);
    const auto& Tr = record_.calibration.Tr;
    const auto& reference = record_.metrics->reference;
    for (const auto& pose : reference) {
        const Eigen::Isometry3d moved = reference.front().inverse() * pose;
        record_.truth.push_back(record_.final.poses.front() *
                                (truthIsCam0_ ? Tr.inverse() * moved * Tr : moved));
    }
}

void Run::findOwnVehicle() {
    slam_.settle();  // the latest scan counts as well
    const Eigen::AlignedBox3d box = slam_.ownVehicle();
    if (box.isEmpty() || record_.rows.empty()) return;
    record_.ownVehicle = box.transformed(record_.rows.back().sensorPose);
    const auto &low = record_.ownVehicle.min(), &high = record_.ownVehicle.max();
    warn(mrpt::format(
        "parts of the own vehicle were found and left out; to leave them out from the first scan "
        "on: --vehicle-box %.2f,%.2f,%.2f,%.2f,%.2f,%.2f",
        low.x(), low.y(), low.z(), high.x(), high.y(), high.z()));
}

void Run::finish(bool complete) {
    const Doubts doubts = doubtsOf(record_.rows);
    for (const auto& warning : warningsOf(doubts)) warn(warning);
    if (doubts.pairs > 0 && doubts.predicted.scans == doubts.pairs)
        fail("no scan could be registered: " + record_.rows[1].reason);
    else if (const auto why = whyUnreliable(doubts); !why.empty())
        fail(why + ": the trajectory is not to be relied on");
    record_.complete = complete;
    record_.imu = slam_.imuReport();
    if (record_.imu)
        for (const auto& finding : record_.imu->findings) warn(finding);
    record_.wheels = slam_.odometryReport();
    if (record_.wheels)
        for (const auto& finding : record_.wheels->findings) warn(finding);
    findOwnVehicle();
    slam_.close();
    optimise();
    if (const auto why = whyUnreliable(unlinkedOf(record_), doubts.pairs); !why.empty())
        fail(why + ": the trajectory is not to be relied on");
    if (map_) record_.options.map = map_->builder().options();  // as they were used
    if (settings_.map && graph_ && loops_) store();
    if (truth_) score();
}

RunRecord optimiseAgain(graph::PoseGraph graph, const Options& options,
                        const RunSettings& settings) {
    RunRecord record;
    record.profile = settings.profile;
    record.command = settings.command;
    record.options = options;
    record.complete = true;
    record.odometry.poses = graph.poses();
    Stopwatch watch;
    record.optimisation = graph.optimise(options.graph);
    record.optimise_ms = watch.lap_ms();
    record.final.poses = graph.poses();
    record.graph = std::move(graph);
    return record;
}
}  // namespace delio::run
