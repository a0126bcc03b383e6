#pragma once
#include <mrpt/opengl/COpenGLScene.h>

namespace delio::picture {
/** How far the points of a scene's map are from one another where a typical one of them lies, if
 *  they lie on surfaces; metres. 0 where there is no map. */
double mapSpacing_m(mrpt::opengl::COpenGLScene& scene);
}  // namespace delio::picture
