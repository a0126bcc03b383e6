#pragma once
#include <mrpt/img/CImage.h>
#include <mrpt/opengl/COpenGLScene.h>

#include <functional>
#include <string>

#include "delio/picture/view.h"

namespace delio::picture {
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
}  // namespace delio::picture
