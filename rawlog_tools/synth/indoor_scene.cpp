#include "indoor_scene.h"

#include <utility>

#include "furnisher.h"
#include "room_shell.h"

namespace delio::synth {
namespace {
constexpr std::uint64_t kShellKey = 0x5E11, kFurnitureKey = 0xF042;

Road roadOf(const FloorPlan& plan, std::uint64_t seed) {
    RoadProfile profile = indoorProfile();
    profile.ramps = plan.ramps();
    return Road(plan.path(), seed, profile);
}
}  // namespace

IndoorScene::IndoorScene(std::uint64_t seed, double length_m)
    : IndoorScene(seed, FloorPlan(seed, length_m + 2 * kPathMargin_m)) {}

IndoorScene::IndoorScene(std::uint64_t seed, FloorPlan plan)
    : Scene(roadOf(plan, seed)), seed_(seed), plan_(std::move(plan)) {}

Mesh IndoorScene::tile(int index) const {
    Mesh mesh;
    for (std::size_t i = 0; i < plan_.spaces().size(); ++i) {
        const Space& space = plan_.spaces()[i];
        if (tileAt(space.begin_s) != index) continue;
        Random shell{seed_, kShellKey, i};
        addShell(mesh, space, shell);
        Furnisher(mesh, space, road(), {seed_, kFurnitureKey, i}).furnish();
    }
    return mesh;
}
}  // namespace delio::synth
