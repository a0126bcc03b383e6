#include "map_input.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "delio/core/error.h"
#include "delio/formats/georeference.h"
#include "delio/map/cloud_files.h"
#include "delio/map/simplemap.h"
#include "delio/places/stored_map.h"
#include "delio/run/run_folder.h"

namespace delio {
namespace fs = std::filesystem;
using run::RunFolder;

namespace {
MapInput readStored(const std::string& path, double spacing_m, const std::string& at) {
    constexpr double kLeast_m = 0.005;  // as its coordinates are rounded
    const StoredMap stored(path);
    std::optional<std::size_t> visit;
    if (!at.empty()) visit = stored.visitAt(at);
    const auto cloud = stored.cloud(std::max(spacing_m, kLeast_m), visit);
    MapInput input;
    input.points.resize(static_cast<std::size_t>(cloud.cols()));
    for (std::size_t i = 0; i < input.points.size(); ++i)
        input.points[i].position = cloud.col(static_cast<Eigen::Index>(i));
    input.earth = stored.georeference();
    if (const auto& origin = stored.cloudOrigin()) {
        input.offset = origin->offset;
        input.wkt = origin->wkt;
    }
    for (const auto& drive : stored.drives()) input.ways.push_back(stored.trajectory(drive).poses);
    return input;
}

MapInput ofPoints(map::MapPoints points) {
    MapInput input;
    input.points = std::move(points);
    return input;
}

MapInput readLas(const std::string& path) {
    auto las = map::loadLas(path);
    MapInput input = ofPoints(std::move(las.points));
    input.offset = las.offset;
    input.wkt = las.wkt;
    return input;
}

MapInput readSimplemap(const std::string& path) {
    const auto simplemap = map::loadSimplemap(path);
    MapInput input = ofPoints(map::pointsOf(map::pointsOf(simplemap)));
    input.keyframes = map::posesOf(simplemap);
    input.ways.push_back(input.keyframes);
    return input;
}

/** The poses of the scans in the map. Its points count their times from the first of these. */
io::Trajectory sensorOf(const RunFolder& folder, const io::ScanTable& table) {
    const auto poses = folder.trajectory().poses;
    io::Trajectory sensor;
    std::optional<double> first_s;
    for (std::size_t i = 0; i < std::min(poses.size(), table.scans.size()); ++i) {
        if (table.predicted[i]) continue;
        sensor.poses.push_back(poses[i]);
        if (!first_s) first_s = table.stamps_s[i];
        sensor.stamps_s.push_back(table.stamps_s[i] - *first_s);
    }
    return sensor;
}

MapInput readFolder(const std::string& path) {
    const RunFolder folder(path);
    MapInput input = ofPoints(map::loadPly(mapFileIn(path)));
    if (folder.has(RunFolder::kDynamicPly))
        input.dynamic = map::loadPly(folder.path(RunFolder::kDynamicPly));
    if (!folder.has(RunFolder::kTrajectory)) return input;
    input.ways.push_back(folder.trajectory().poses);
    if (folder.has(RunFolder::kGeoreference))
        input.earth = io::readGeoreference(folder.path(RunFolder::kGeoreference));
    if (folder.has(RunFolder::kScans)) {
        const auto table = folder.scans();
        input.sensor = sensorOf(folder, table);
        constexpr double kFirstUnix_s = 5e8;  // smaller stamps count from the start of the drive
        if (!table.stamps_s.empty() && table.stamps_s.front() > kFirstUnix_s)
            input.firstScan_unix_s = table.stamps_s.front();
    }
    if (folder.has(RunFolder::kLoops))
        for (const auto& loop : folder.loops())
            if (loop.accepted) input.loops.emplace_back(loop.fromNode, loop.toNode);
    return input;
}

MapInput readAny(const std::string& path, double storedSpacing_m, const std::string& at) {
    const std::string kind = fs::path(path).extension().string();
    if (fs::is_directory(path)) return readFolder(path);
    if (kind == ".simplemap") return readSimplemap(path);
    if (kind == ".delio") return readStored(path, storedSpacing_m, at);
    if (kind == ".ply") return ofPoints(map::loadPly(path));
    if (kind == ".pcd") return ofPoints(map::loadPcd(path));
    if (kind == ".las") return readLas(path);
    throw Error(
        "cannot read '" + path +
        "': give the folder of a delio-slam run, or a .ply, .pcd, .las, .simplemap or .delio file");
}
}  // namespace

Eigen::Isometry3d MapInput::firstPose() const {
    for (const auto& way : ways)
        if (!way.empty()) return way.front();
    return Eigen::Isometry3d::Identity();
}

std::optional<Eigen::Vector3d> MapInput::north() const {
    if (earth) return earth->north();
    return {};
}

picture::MapWays MapInput::drawnWays() const {
    picture::MapWays drawn;
    drawn.loops = loops;
    drawn.keyframes = keyframes;
    drawn.north = north();
    for (const auto& way : ways)
        (drawn.trajectory.empty() ? drawn.trajectory : drawn.others.emplace_back()) = way;
    return drawn;
}

std::string mapFileIn(const std::string& path) {
    if (!fs::is_directory(path)) return path;
    const RunFolder folder(path);
    if (folder.has(RunFolder::kPly)) return folder.path(RunFolder::kPly);
    throw Error("'" + path + "' contains no " + RunFolder::kPly +
                "; give the folder of a finished delio-slam run (without --no-map)");
}

std::vector<std::string> mapFilesIn(const std::string& path) {
    if (!fs::is_directory(path)) return {path};
    const RunFolder folder(path);
    std::vector<std::string> files;
    for (const auto& name :
         {RunFolder::kPly, RunFolder::kDynamicPly, RunFolder::kTrajectory, RunFolder::kLoops})
        files.push_back(folder.path(name));
    return files;
}

MapInput readMap(const std::string& path, double storedSpacing_m, const std::string& at) {
    MapInput input = readAny(path, storedSpacing_m, at);
    const fs::path name = fs::absolute(path).lexically_normal();
    input.name = (name.has_filename() ? name : name.parent_path()).stem().string();
    if (input.points.empty()) throw Error("'" + path + "' is an empty map");
    return input;
}
}  // namespace delio
