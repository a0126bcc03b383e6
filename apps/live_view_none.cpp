// Replacement of the live view without mrpt-gui.
#include "delio/core/error.h"
#include "live_view.h"

namespace delio {
struct LiveView::Window {};

// NOLINTNEXTLINE(performance-unnecessary-value-param): as in live_view.cpp
LiveView::LiveView(std::shared_ptr<const LiveMap>) {
    throw Error(
        "this delio-slam was built without the live view; install libmrpt-gui-dev and rebuild, or "
        "leave out --gui");
}
LiveView::~LiveView() = default;
bool LiveView::isOpen() const { return false; }
}  // namespace delio
