// Where mrpt-gui is not installed there is no live view.
#include "delio/error.h"
#include "live_view.h"

namespace delio {
struct LiveView::Window {};

LiveView::LiveView(const OdometryOptions&) {
    throw Error(
        "this delio-slam has no live view: install libmrpt-gui-dev and build it again, or leave "
        "out --gui");
}
LiveView::~LiveView() = default;
void LiveView::show(const Scan&, const mrpt::poses::CPose3D&, const mrpt::poses::CPose3D&) {}
bool LiveView::isOpen() const { return false; }
}  // namespace delio
