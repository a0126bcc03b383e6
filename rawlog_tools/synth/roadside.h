#pragma once
#include <cstdint>
#include <utility>

#include "random.h"
#include "scene.h"

namespace delio::synth {
/** Common part of scenes along a road: free places beside it. */
class RoadsideScene : public Scene {
 public:
    RoadsideScene(Road road, std::uint64_t seed) : Scene(std::move(road)), seed_(seed) {}

 protected:
    /** For one part of what stands on one side (-1, +1) of a tile: changing one part leaves the
     *  others as they are. */
    Random stream(int tile, double side, std::uint64_t part) const;
    /** The same for a stretch of road that reaches over several tiles. */
    Random stretchStream(double s, double length_m, double side, std::uint64_t part) const;
    /** On the ground at `side`, x along the road, y away from it. */
    Frame frameAt(double s, double side) const;
    /** No part of the rectangle `length` x `width` about the frame's origin is nearer to any road
     *  than `clearance` or in the vehicle's way, and none belongs to another stretch of road. */
    bool isFree(const Frame& frame, double s, double length, double width, double clearance) const;
    /** The same for what stands between `s0` and `s1`, at `side`. */
    bool isStripFree(double s0, double s1, double side) const;
    double sharpestCurvature(double begin_s, double end_s) const;
    std::uint64_t seed() const { return seed_; }
    /** stream() of another seed. */
    static Random streamOf(std::uint64_t seed, int tile, double side, std::uint64_t part);

 private:
    std::uint64_t seed_;
};
}  // namespace delio::synth
