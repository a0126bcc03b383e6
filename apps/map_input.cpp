#include "map_input.h"

#include <algorithm>
#include <filesystem>

#include "delio/core/error.h"
#include "delio/localisation/stored_map.h"
#include "delio/map/pcd.h"
#include "delio/map/ply.h"
#include "delio/map/simplemap.h"
#include "delio/run/run_folder.h"

namespace delio {
namespace fs = std::filesystem;
using run::RunFolder;

namespace {
MapInput readStored(const std::string& path, double spacing_m) {
    constexpr double kLeast_m = 0.005;  // as its coordinates are rounded
    const StoredMap stored(path);
    const auto cloud = stored.cloud(std::max(spacing_m, kLeast_m));
    MapInput input;
    input.points.resize(static_cast<std::size_t>(cloud.cols()));
    for (std::size_t i = 0; i < input.points.size(); ++i)
        input.points[i].position = cloud.col(static_cast<Eigen::Index>(i));
    for (const auto& drive : stored.drives()) input.ways.push_back(stored.trajectory(drive).poses);
    return input;
}

MapInput readSimplemap(const std::string& path) {
    const auto simplemap = map::loadSimplemap(path);
    const auto poses = map::posesOf(simplemap);
    return {map::pointsOf(map::pointsOf(simplemap)), {poses}, poses};
}

MapInput readFolder(const std::string& path) {
    const RunFolder folder(path);
    MapInput input{map::loadPly(mapFileIn(path)), {}, {}};
    if (folder.has(RunFolder::kTrajectory)) input.ways.push_back(folder.trajectory().poses);
    return input;
}

MapInput readAny(const std::string& path, double storedSpacing_m) {
    const std::string kind = fs::path(path).extension().string();
    if (fs::is_directory(path)) return readFolder(path);
    if (kind == ".simplemap") return readSimplemap(path);
    if (kind == ".delio") return readStored(path, storedSpacing_m);
    if (kind == ".ply") return {map::loadPly(path), {}, {}};
    if (kind == ".pcd") return {map::loadPcd(path), {}, {}};
    throw Error("cannot read '" + path +
                "': a map is the folder of a delio-slam run, or a file whose name ends in .ply, "
                ".pcd, .simplemap or .delio");
}
}  // namespace

Eigen::Isometry3d MapInput::firstPose() const {
    for (const auto& way : ways)
        if (!way.empty()) return way.front();
    return Eigen::Isometry3d::Identity();
}

picture::MapWays MapInput::drawnWays() const {
    picture::MapWays drawn;
    drawn.keyframes = keyframes;
    for (const auto& way : ways)
        (drawn.trajectory.empty() ? drawn.trajectory : drawn.others.emplace_back()) = way;
    return drawn;
}

std::string mapFileIn(const std::string& path) {
    if (!fs::is_directory(path)) return path;
    const RunFolder folder(path);
    if (folder.has(RunFolder::kPly)) return folder.path(RunFolder::kPly);
    throw Error("'" + path + "' holds no " + RunFolder::kPly +
                ": is it the folder of a delio-slam run (without --no-map) that has ended?");
}

MapInput readMap(const std::string& path, double storedSpacing_m) {
    MapInput input = readAny(path, storedSpacing_m);
    if (input.points.empty()) throw Error("'" + path + "' is an empty map: nothing is in it");
    return input;
}
}  // namespace delio
