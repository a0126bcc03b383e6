#pragma once
#include <mrpt/img/CImage.h>
#include <mrpt/img/TColor.h>
#include <mrpt/opengl/COpenGLScene.h>

#include <functional>
#include <optional>
#include <string>

namespace delio::picture {
/** Camera and style of a picture. Unset values are chosen so that the whole content (without
 *  outliers) fills the picture. */
struct SnapshotOptions {
    unsigned width_px = 1920;   //!< 1 to kMaxPictureSize_px
    unsigned height_px = 1080;  //!< likewise

    /** Direction from which the camera looks: 0 from +x, 90 from +y. Unset: such that the longer
     *  side of the content lies across the picture (looking straight down: turned by right angles
     *  only, +x to the right or up). */
    std::optional<double> azimuth_deg;
    double elevation_deg = 55;     //!< above the horizon; 90 looks straight down
    std::optional<double> zoom_m;  //!< metres across the picture, through the content's middle
    bool ortho = false;            //!< parallel projection instead of perspective
    /** In the lower right corner: of a round length; in perspective of the middle of the content.
     */
    bool scaleBar = false;
    /** Above it: to north, where the scene has it (MapWays::north), else along its y axis. */
    bool northArrow = false;
    /** Of all point clouds; unset: the scene's, which are meant for pictures of 1080 lines, larger
     * in larger pictures and from nearer (a map's: such that its surfaces look closed). */
    std::optional<float> pointSize_px;
    std::optional<mrpt::img::TColor> background;  //!< unset: the scene's
    /** Of the points of a map where others in front of them are near: edge shading. 0: off; 1:
     *  default. Scenes without a map are never shaded. */
    double shading = 1;
    /** Factor of the size of letters, lines and symbols; 4: legible in a column of print. */
    double marks = 1;
};

/** The longest side of a picture, pixels. */
constexpr unsigned kMaxPictureSize_px = 16384;

/** Straight from above in parallel projection, with a scale bar. */
SnapshotOptions topView();

/** Renders without a display (EGL, in software where there is no GPU). The scene is the same again
 *  afterwards. Throws Error if the scene is empty, the size is out of range, or no EGL device can
 *  be used. */
mrpt::img::CImage picture(mrpt::opengl::COpenGLScene& scene, const SnapshotOptions& options);

/** As many pictures with the camera going once around the scene, from options.azimuth_deg (unset:
 *  as picture() chooses) on, at one distance from which everything is seen all the way; each is
 *  given to `use` with its number, from 0. Throws Error as picture() does. */
void orbit(mrpt::opengl::COpenGLScene& scene, const SnapshotOptions& options, unsigned pictures,
           const std::function<void(unsigned, const mrpt::img::CImage&)>& use);

/** picture() into a .png file. Throws Error also if that cannot be written. */
void savePicture(mrpt::opengl::COpenGLScene& scene, const SnapshotOptions& options,
                 const std::string& pngPath);

/** Throws Error for a name that does not end in .png: to be asked before the work is done. */
void checkPngName(const std::string& path);

/** Writes a .png. Throws Error if that fails, or for a name that does not end in .png. */
void savePng(const mrpt::img::CImage& image, const std::string& path);
}  // namespace delio::picture
