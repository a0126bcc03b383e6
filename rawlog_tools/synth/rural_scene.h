#pragma once
#include "fence.h"
#include "roadside.h"

namespace delio::synth {
/** A country road: fields, banks, fences and hedges, trees, bushes and few houses. */
class RuralScene : public RoadsideScene {
 public:
    using RoadsideScene::RoadsideScene;
    Mesh tile(int index) const override;

 protected:
    /** Grass, bushes and trees between `near` and `far` from the centre line. */
    void addGrowth(Mesh& mesh, double begin_s, double side, double near, double far,
                   Random random) const;

 private:
    void addBoundary(Mesh& mesh, double begin_s, double side, Random random) const;
    void addHedgeRow(Mesh& mesh, double s0, double s1, double side, Random& random) const;
    void addFarm(Mesh& mesh, double begin_s, double side, Random random) const;
    void addPosts(Mesh& mesh, double begin_s, double side, Random random) const;
    Feet feetBetween(double s0, double s1, double step, double side) const;
};
}  // namespace delio::synth
