#pragma once
#include "ray_caster.h"
#include "scene.h"

namespace delio::synth {
/** Keeps the tiles near the vehicle in the ray caster, and only those. */
class TileWindow {
 public:
    /** Round a corner 180 m of road reach as far as 120 m straight. */
    static constexpr double kReach_m = 180;

    TileWindow(const Scene& scene, RayCaster& caster) : scene_(scene), caster_(caster) {}
    void moveTo(double s);

 private:
    const Scene& scene_;
    RayCaster& caster_;
};
}  // namespace delio::synth
