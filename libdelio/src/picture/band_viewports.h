#pragma once
#include <mrpt/opengl/COpenGLScene.h>

#include <vector>

namespace delio::picture {
/** Moves the viewports of a scene up and down such that what MRPT renders into a buffer of a few
 *  rows is a band of the whole picture: the same pixels. In the end they are where they were. */
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
