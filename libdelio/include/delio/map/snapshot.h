#pragma once
#include <mrpt/img/CImage.h>
#include <mrpt/img/TColor.h>
#include <mrpt/opengl/COpenGLScene.h>

#include <optional>
#include <string>

namespace delio::map {
/** From where a scene is looked at, and how. What is not set is chosen so that the whole content
 *  (without stray points) fills the picture. */
struct SnapshotOptions {
    unsigned width_px = 1920;  //!< 1 to kMaxPictureSize_px
    unsigned height_px = 1080;

    /** Where the camera stands, seen from the content: 0 on the side of +x, 90 of +y. Unset: such
     *  that the longer side of the content lies across the picture (looking straight down: turned
     *  by right angles only, +x to the right or up). */
    std::optional<double> azimuth_deg;
    double elevation_deg = 55;          //!< above the horizon; 90 looks straight down
    std::optional<double> zoom_m;       //!< metres across the picture, through the content's middle
    bool ortho = false;                 //!< parallel projection instead of perspective
    std::optional<float> pointSize_px;  //!< of all point clouds; unset: the scene's
    std::optional<mrpt::img::TColor> background;  //!< unset: the scene's
};

constexpr unsigned kMaxPictureSize_px = 16384;

/** A map seen straight from above in parallel projection, true to scale: for trajectory.png. */
SnapshotOptions topView();

/** Renders without a display (EGL, in software where there is no GPU). The scene is the same again
 *  afterwards. Throws Error if the scene is empty, the size is out of range, or no EGL device can
 *  be used. */
mrpt::img::CImage picture(mrpt::opengl::COpenGLScene& scene, const SnapshotOptions& options);

/** The same into a .png file. Throws Error also if that cannot be written. */
void savePicture(mrpt::opengl::COpenGLScene& scene, const SnapshotOptions& options,
                 const std::string& pngPath);
}  // namespace delio::map
