#pragma once
#include <cstdint>

#include "random.h"
#include "scene.h"

namespace delio::synth {
/** A street of houses with gaps between them, front gardens, trees, parked cars and the furniture
 *  of sidewalks. */
class UrbanScene : public Scene {
 public:
    UrbanScene(Road road, std::uint64_t seed) : Scene(std::move(road)), seed_(seed) {}
    Mesh tile(int index) const override;

 private:
    void addHouses(Mesh& mesh, double begin_s, double side, Random random) const;
    void addHouse(Mesh& mesh, double s0, double s1, double side, Random& random) const;
    /** Trees and bushes in a gap between houses. */
    void addYard(Mesh& mesh, double s, double side, Random& random) const;
    void addFrontGarden(Mesh& mesh, double s0, double s1, double side, Random& random) const;
    void addBackRow(Mesh& mesh, double begin_s, double side, Random random) const;
    void addParkedCars(Mesh& mesh, double begin_s, double side, Random random) const;
    void addSidewalk(Mesh& mesh, double begin_s, double side, Random random) const;

    /** On the ground at `side`, x along the street, y away from it. */
    Frame frameAt(double s, double side) const;
    /** No part of the rectangle `length` x `width` about the frame's origin is nearer to the centre
     *  line than `clearance`. */
    bool isFree(const Frame& frame, double s, double length, double width, double clearance) const;

    std::uint64_t seed_;
};
}  // namespace delio::synth
