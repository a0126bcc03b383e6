#pragma once
#include <cstdint>
#include <optional>

#include "roadside.h"

namespace delio::synth {
/** A street of houses with gaps between them, front gardens, trees, parked cars and the furniture
 *  of sidewalks. */
class UrbanScene : public RoadsideScene {
 public:
    using RoadsideScene::RoadsideScene;
    Mesh tile(int index) const override;
    /** Other parked cars than those of the world's seed; 0: none. */
    void park(std::uint64_t seed) { parkedSeed_ = seed; }

 private:
    void addHouses(Mesh& mesh, double begin_s, double side, Random random) const;
    void addHouse(Mesh& mesh, double s0, double s1, double side, Random& random) const;
    /** Trees and bushes in a gap between houses. */
    void addYard(Mesh& mesh, double s, double side, Random& random) const;
    void addFrontGarden(Mesh& mesh, double s0, double s1, double side, Random& random) const;
    void addBackRow(Mesh& mesh, double begin_s, double side, Random random) const;
    void addParkedCars(Mesh& mesh, double begin_s, double side, Random random) const;
    void addSidewalk(Mesh& mesh, double begin_s, double side, Random random) const;

    std::optional<std::uint64_t> parkedSeed_;
};
}  // namespace delio::synth
