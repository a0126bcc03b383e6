#pragma once
#include <cstdint>

#include "floor_plan.h"
#include "scene.h"

namespace delio::synth {
/** A house of rooms and corridors on two levels, with stairs and ramps between them, furnished. */
class IndoorScene : public Scene {
 public:
    /** For a walk of at least `length_m`. */
    IndoorScene(std::uint64_t seed, double length_m);
    /** The spaces that the walk enters there. */
    Mesh tile(int index) const override;
    const FloorPlan& plan() const { return plan_; }

 private:
    IndoorScene(std::uint64_t seed, FloorPlan plan);

    std::uint64_t seed_;
    FloorPlan plan_;
};
}  // namespace delio::synth
