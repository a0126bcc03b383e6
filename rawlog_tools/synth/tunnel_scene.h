#pragma once
#include <cstdint>
#include <utility>

#include "rural_scene.h"

namespace delio::synth {
/** A straight tunnel with smooth walls on an even grade: inside, scans do not show how far one has
 *  gone. The drive begins in it by default, already in motion, its mouth out of sight; after 5 km
 *  it leads out into open country. */
class TunnelScene : public RuralScene {
 public:
    static constexpr double kBegin_m = -kPathMargin_m, kEnd_m = 5000;  //!< stations of its mouths

    TunnelScene(Road road, std::uint64_t seed, double begin_m = kBegin_m, double end_m = kEnd_m)
        : RuralScene(std::move(road), seed), begin_m_(begin_m), end_m_(end_m) {}
    Mesh tile(int index) const override;

 private:
    void addLining(Mesh& mesh, double begin_s, double end_s) const;
    void addPortal(Mesh& mesh, double s) const;

    double begin_m_, end_m_;
};
}  // namespace delio::synth
