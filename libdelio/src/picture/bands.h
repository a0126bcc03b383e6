#pragma once
#include <cstddef>
#include <vector>

namespace delio::picture {
/** Rows of a picture that are drawn at once; they count from above. */
struct Band {
    unsigned first;       //!< that is drawn
    unsigned begin, end;  //!< of the rows that are wanted; each row is in one band
};

/** A picture that is drawn in bands of the same height, in buffers of one band: OpenGL's and ours
 * take some 25 bytes a pixel, and a picture is drawn at twice its size. Each band draws the whole
 * scene: one of many points, which takes more by itself, is drawn in fewer. */
struct Bands {
    /** @param margin rows that are drawn on either side of those that are wanted, unless the
     * picture ends there; begin and end are even where margin and height are */
    Bands(unsigned width, unsigned height, unsigned margin, std::size_t scenePoints);

    unsigned rows;  //!< of each one
    std::vector<Band> all;
};
}  // namespace delio::picture
