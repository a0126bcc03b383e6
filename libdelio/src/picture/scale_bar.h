#pragma once
#include <mrpt/img/CImage.h>
#include <mrpt/img/TColor.h>

#include <string>

#include "framing.h"

namespace delio::picture {
/** A bar of a round length in the lower right corner of a picture, and its text. Pixels count from
 *  the upper left corner. */
struct ScaleBar {
    ScaleBar(const View& view, const SnapshotOptions& options);
    void drawInto(mrpt::img::CImage& image, const mrpt::img::TColor& ink) const;

    int width_px, height_px, right_px, bottom_px;
    std::string text;
};
}  // namespace delio::picture
