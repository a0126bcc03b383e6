#pragma once
#include "rural_scene.h"

namespace delio::synth {
/** A straight tunnel with smooth walls on an even grade: inside, scans do not show how far one has
 *  gone. The drive begins in it, already in motion, its mouth out of sight; after 5 km it leads out
 *  into open country. */
class TunnelScene : public RuralScene {
 public:
    static constexpr double kBegin_m = -kPathMargin_m, kEnd_m = 5000;  //!< stations of its mouths

    using RuralScene::RuralScene;
    Mesh tile(int index) const override;

 private:
    void addLining(Mesh& mesh, double begin_s, double end_s) const;
    void addPortal(Mesh& mesh, double s) const;
};
}  // namespace delio::synth
