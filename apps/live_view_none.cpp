// Replacement of the live view without mrpt-gui.
#include "delio/core/error.h"
#include "live_view.h"

namespace delio {
struct LiveView::Window {};

LiveView::LiveView(const PaperOdometryOptions&) {
    throw Error(
        "this delio-slam was built without the live view; install libmrpt-gui-dev and rebuild, or "
        "leave out --gui");
}
LiveView::~LiveView() = default;
void LiveView::add(const SlamScan&) {}
bool LiveView::isOpen() const { return false; }
}  // namespace delio
