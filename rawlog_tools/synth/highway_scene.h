#pragma once
#include "fence.h"
#include "roadside.h"

namespace delio::synth {
/** A highway: guard rails, noise walls in stretches, few bridges, gantries and plates, trees on
 *  banks, and little else. */
class HighwayScene : public RoadsideScene {
 public:
    using RoadsideScene::RoadsideScene;
    Mesh tile(int index) const override;

 private:
    void addRails(Mesh& mesh, double begin_s, double side) const;
    void addWall(Mesh& mesh, double begin_s, double side) const;
    void addTrees(Mesh& mesh, double begin_s, double side, Random random) const;
    void addSigns(Mesh& mesh, double begin_s, double side, Random random) const;
    void addCrossings(Mesh& mesh, int index) const;
    /** Pairs of feet between which nothing is in the way. */
    std::vector<Feet> freeFeet(double begin_s, double side) const;
    bool hasWall(double s, double side) const;
};
}  // namespace delio::synth
