#pragma once
#include <mrpt/img/CImage.h>
#include <mrpt/opengl/COpenGLScene.h>

#include <string>
#include <vector>

namespace delio::picture {
/** Texts and a colour bar over a rendered picture, each on a plate of the background's colour, so
 *  that they are readable over points. Pixels of the rendered picture, from its lower left corner.
 */
class LegendLayer {
 public:
    /** @param around_px how far plates reach beyond what is on them */
    LegendLayer(const mrpt::img::TColorf& background, double around_px);

    void addText(double x, double y, const std::string& text,
                 const mrpt::opengl::TFontParams& font);
    /** A viewport with an image, at another place. */
    void addBar(const mrpt::opengl::COpenGLViewport& bar, double x, double y, double width,
                double height);
    /** The plate of what somebody else draws there. */
    void addPlate(double x, double y, double width, double height);

    /** To be rendered as large as the picture. */
    mrpt::opengl::COpenGLScene& scene() { return scene_; }

    /** Whether some of it is in these rows, which count from below. */
    bool isInRows(int lowest, int highest) const;

    /** Copies the plates with what is on them from a picture of scene() to one of the same rows,
     *  the lowest of which is `lowest`. */
    void copy(const mrpt::img::CImage& from, mrpt::img::CImage& to, int lowest) const;

 private:
    struct Plate {
        int left, bottom, right, top;
    };

    double around_px_;
    mrpt::opengl::COpenGLScene scene_;
    std::vector<Plate> plates_;
    unsigned texts_ = 0, bars_ = 0;
};
}  // namespace delio::picture
