#include "delio/picture/view.h"

namespace delio::picture {
SnapshotOptions topView() {
    SnapshotOptions options;
    options.elevation_deg = 90;
    options.ortho = true;
    options.scaleBar = true;
    return options;
}
}  // namespace delio::picture
