#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <utility>
#include <vector>

#include "random.h"
#include "scene.h"

namespace delio::synth {
/** A wood on uneven ground, with a track of two ruts between the trees: trunks, branches, bushes,
 *  ferns and fallen wood, and no plane. What grows at a place depends on the place alone. */
class ForestScene : public Scene {
 public:
    static constexpr double kDeep_m = 45;  //!< so far from the track, trees stand

    struct Trunk {
        Eigen::Vector2d place;
        double diameter_m;
    };

    ForestScene(Road road, std::uint64_t seed) : Scene(std::move(road)), seed_(seed) {}
    Mesh tile(int index) const override;
    /** The trees that belong to a tile: the track is nowhere nearer to them. */
    std::vector<Trunk> trunks(int index) const;

 private:
    /** Where something grows. */
    struct Spot {
        Eigen::Vector2d place;
        double away_m;  //!< from the middle of the track
        Random random;
    };
    std::vector<Spot> spots(int index, std::uint64_t key, double apart_m) const;
    std::vector<std::pair<Trunk, Spot>> trees(int index) const;
    void addUndergrowth(Mesh& mesh, const Spot& spot) const;
    Frame frameAt(const Spot& spot, Random& random) const;

    std::uint64_t seed_;
};
}  // namespace delio::synth
