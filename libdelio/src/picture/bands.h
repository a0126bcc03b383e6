#pragma once
#include <mrpt/opengl/COpenGLScene.h>

#include <cstddef>
#include <vector>

namespace delio::picture {
/** Rows of a picture that are drawn at once; they count from above. */
struct Band {
    unsigned first;       //!< that is drawn
    unsigned begin, end;  //!< of the rows that are wanted; each row is in one band
};

/** Divides a picture into bands of equal height that are drawn one after the other into one buffer.
 *  This saves memory: OpenGL and DeLiO take about 25 bytes a pixel, and a picture is drawn at twice
 *  its size. Each band draws the whole scene, so a scene of many points gets fewer bands. */
struct Bands {
    /** @param margin extra rows above and below each band, except at the picture's edges; begin and
     *  end are even where margin and height are */
    Bands(unsigned width, unsigned height, unsigned margin, std::size_t scenePoints);

    unsigned rows;  //!< of each one
    std::vector<Band> all;
};

/** Shifts the viewports of a scene so that MRPT renders one band of the whole picture into a buffer
 *  of a few rows, with the same pixels. The destructor restores the viewports. */
class BandViewports {
 public:
    /** @param height of the picture, @param rows of the buffer */
    BandViewports(mrpt::opengl::COpenGLScene& scene, unsigned height, unsigned rows);
    ~BandViewports();
    BandViewports(const BandViewports&) = delete;
    BandViewports& operator=(const BandViewports&) = delete;

    /** The band that begins with this row of the picture, counted from above. */
    void show(unsigned first);

 private:
    struct Place {
        mrpt::opengl::COpenGLViewport::Ptr viewport;
        double x, y, width, height;  //!< as they were
        int bottom_px, height_px;    //!< in the picture
    };
    int pictureHeight_, rows_;
    std::vector<Place> places_;
};
}  // namespace delio::picture
