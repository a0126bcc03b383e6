#include "scale_bar.h"

#include <cmath>

#include "marks.h"
#include "round_length.h"

namespace delio::picture {
ScaleBar::ScaleBar(const View& view, const SnapshotOptions& options) {
    const double length_m = roundLength(view.metresAcross / 8);
    const double marks = sizeOfMarks(options);
    width_px = static_cast<int>(std::lround(length_m / view.metresAcross * options.width_px));
    height_px = static_cast<int>(std::lround(6 * marks));
    right_px = static_cast<int>(options.width_px) - static_cast<int>(25 * marks);
    bottom_px = static_cast<int>(options.height_px) - static_cast<int>(25 * marks);
    text = metresText(length_m);
}

void ScaleBar::drawInto(mrpt::img::CImage& image, const mrpt::img::TColor& ink) const {
    image.filledRectangle(right_px - width_px, bottom_px - height_px, right_px, bottom_px, ink);
}
}  // namespace delio::picture
