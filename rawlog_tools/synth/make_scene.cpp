#include "make_scene.h"

#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>

#include "block_path.h"
#include "country_paths.h"
#include "delio/core/error.h"
#include "drive.h"
#include "forest_scene.h"
#include "highway_scene.h"
#include "indoor_scene.h"
#include "recording.h"
#include "rural_scene.h"
#include "tunnel_scene.h"
#include "urban_scene.h"

namespace delio::synth {
namespace {
struct Kind {
    std::string name;
    RoadProfile profile;
    /** Along a path of its own. */
    std::function<std::unique_ptr<Scene>(std::uint64_t seed, double length_m)> make;
    /** Along a given one; none: it cannot. */
    std::function<std::unique_ptr<Scene>(Road road, std::uint64_t seed)> build;
};

template <typename Built>
std::unique_ptr<Scene> build(Road road, std::uint64_t seed) {
    return std::make_unique<Built>(std::move(road), seed);
}

/** A scene that can be built along any road. */
template <typename Built, typename PathOf>
Kind roadKind(const std::string& name, const RoadProfile& profile, PathOf pathOf) {
    const auto make = [=](std::uint64_t seed, double length_m) {
        return build<Built>(Road(pathOf(seed, length_m), seed, profile), seed);
    };
    return {name, profile, make, build<Built>};
}

/** One that has a path of its own. */
Kind withoutTrajectory(Kind kind) {
    kind.build = nullptr;
    return kind;
}

std::vector<Kind> kinds() {
    const auto straight = [](std::uint64_t, double length_m) { return straightPath(length_m); };
    const auto block = [](std::uint64_t seed, double length_m) {
        return blockPath(seed, length_m, blockProfile().lanes.front().side_m);
    };
    // Open country, then 500 m of tunnel, then open country.
    const auto portal = [](std::uint64_t seed, double length_m) {
        constexpr double kBegin_m = 200, kEnd_m = 700;
        return std::make_unique<TunnelScene>(Road(straightPath(length_m), seed, tunnelProfile()),
                                             seed, kBegin_m, kEnd_m);
    };
    const auto house = [](std::uint64_t seed, double length_m) {
        return std::make_unique<IndoorScene>(seed, length_m);
    };
    return {roadKind<UrbanScene>("urban", urbanProfile(), urbanPath),
            roadKind<RuralScene>("rural", ruralProfile(), ruralPath),
            roadKind<HighwayScene>("highway", highwayProfile(), highwayPath),
            withoutTrajectory(roadKind<UrbanScene>("loop", blockProfile(), block)),
            withoutTrajectory(roadKind<TunnelScene>("tunnel", tunnelProfile(), straight)),
            {"portal", tunnelProfile(), portal, nullptr},
            {"indoor", indoorProfile(), house, nullptr},
            withoutTrajectory(roadKind<ForestScene>("forest", forestProfile(), forestPath))};
}

Kind kindOf(const std::string& name) {
    for (auto& kind : kinds())
        if (kind.name == name) return kind;
    throw std::invalid_argument("no scene '" + name + "'");
}
/** The middle of a wide road lies far to the left of the vehicle: in a sharp turn it would run
 *  backwards. */
void refuseSharpTurns(const Recording& recording, const Kind& kind, const std::string& file) {
    const double toCentre_m = -kind.profile.lanes.front().side_m;
    for (double s = 0; s < recording.path().end() - 2 * kPathMargin_m; s += 1)
        if (recording.path().at(s).curvature * toCentre_m > 0.5)
            throw Error("'" + file + "' turns too sharply for a " + kind.name + ", " +
                        std::to_string(std::lround(s)) + " m from its start; use --scene urban");
}
}  // namespace

std::vector<std::string> sceneNames() {
    std::vector<std::string> names;
    for (const auto& kind : kinds()) names.push_back(kind.name);
    return names;
}

bool takesTrajectory(const std::string& sceneName) { return kindOf(sceneName).build != nullptr; }

bool hasParkedCars(const std::string& sceneName) {
    return sceneName == "urban" || sceneName == "loop";
}

namespace {
std::unique_ptr<Scene> makeWorld(const SceneRequest& request) {
    const Kind kind = kindOf(request.name);
    if (!request.trajectory.empty()) {
        const auto recording =
            std::make_shared<const Recording>(request.trajectory, request.lidarToCam0);
        refuseSharpTurns(*recording, kind, request.trajectory);
        return kind.build(Road(recording->path(), request.seed, kind.profile, recording),
                          request.seed);
    }
    const double longest_m =
        kind.profile.style.fastest_m_s * kScanPeriod_s * static_cast<double>(request.scans);
    return kind.make(request.seed, longest_m);
}
}  // namespace

std::unique_ptr<Scene> makeScene(const SceneRequest& request) {
    auto scene = makeWorld(request);
    if (auto* street = dynamic_cast<UrbanScene*>(scene.get()); street && request.parkedSeed)
        street->park(*request.parkedSeed);
    return scene;
}
}  // namespace delio::synth
