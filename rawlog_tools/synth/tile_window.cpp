#include "tile_window.h"

namespace delio::synth {
void TileWindow::moveTo(double s) {
    const int first = Scene::tileAt(s - kReach_m), last = Scene::tileAt(s + kReach_m);
    bool changed = false;
    for (const int index : caster_.ids()) {
        if (index >= first && index <= last) continue;
        caster_.remove(index);
        changed = true;
    }
    for (int index = first; index <= last; ++index) {
        if (caster_.has(index)) continue;
        caster_.add(index, scene_.tile(index));
        changed = true;
    }
    if (changed) caster_.commit();
}
}  // namespace delio::synth
