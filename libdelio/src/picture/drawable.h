#pragma once
#include <mrpt/opengl/COpenGLScene.h>

namespace delio::picture {
/** Sees to it that MRPT can draw a scene that was read from a file: round shapes get as many
 *  corners as they are seen with at most. Throws Error for a scene without a main view, and for
 *  grids and axes whose lines it would draw for ever. */
void makeDrawable(mrpt::opengl::COpenGLScene& scene);
}  // namespace delio::picture
