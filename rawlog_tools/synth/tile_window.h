#pragma once
#include <set>

#include "ray_caster.h"
#include "scene.h"

namespace delio::synth {
/** Keeps the tiles near the vehicle in the ray caster, and only those. */
class TileWindow {
 public:
    /** Between the vehicle and the road of a tile; what stands beside that road may be nearer. */
    static constexpr double kReach_m = 150;

    TileWindow(const Scene& scene, RayCaster& caster, double reach_m = kReach_m)
        : scene_(scene), caster_(caster), reach_m_(reach_m) {}
    /** To where the path is at `s`. */
    void moveTo(double s);

 private:
    const Scene& scene_;
    RayCaster& caster_;
    double reach_m_;
    std::set<int> held_;
};
}  // namespace delio::synth
