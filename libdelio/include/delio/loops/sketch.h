#pragma once
#include <utility>

#include "delio/loops/azimuths.h"
#include "delio/loops/height_image.h"

namespace delio::loops {
/** What a place is looked for by: which way its walls look, and what stands where. */
struct Sketch {
    Azimuths azimuths;
    HeightImage image;

    /** Of a levelled cloud, metres. */
    explicit Sketch(const Eigen::Matrix3Xf& points);
    Sketch(Azimuths itsAzimuths, HeightImage itsImage)
        : azimuths(std::move(itsAzimuths)), image(std::move(itsImage)) {}
};
}  // namespace delio::loops
