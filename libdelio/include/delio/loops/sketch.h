#pragma once
#include <utility>

#include "delio/loops/azimuths.h"
#include "delio/loops/height_image.h"

namespace delio::loops {
/** What a place is looked for by: which way its walls look, and what stands where. */
struct Sketch {
    Azimuths azimuths;  //!< which way its walls look
    HeightImage image;  //!< what stands where

    /** Of a levelled cloud, metres. */
    explicit Sketch(const Eigen::Matrix3Xf& points);
    /** Of what another one was made of. */
    Sketch(Azimuths itsAzimuths, HeightImage itsImage)
        : azimuths(std::move(itsAzimuths)), image(std::move(itsImage)) {}
};
}  // namespace delio::loops
