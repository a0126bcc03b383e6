#include "tile_window.h"

#include <utility>

namespace delio::synth {
void TileWindow::moveTo(double s) {
    const auto wanted = scene_.tilesNear(s, reach_m_);
    if (wanted == held_) return;
    for (const int index : held_)
        if (wanted.count(index) == 0 && caster_.has(index)) caster_.remove(index);
    for (const int index : wanted) {
        if (held_.count(index) != 0) continue;
        Mesh mesh = scene_.tile(index);
        if (!mesh.triangles().empty()) caster_.add(index, std::move(mesh));
    }
    held_ = wanted;
    caster_.commit();
}
}  // namespace delio::synth
