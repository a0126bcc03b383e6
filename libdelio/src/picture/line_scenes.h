#pragma once
#include <mrpt/opengl/COpenGLScene.h>

#include <Eigen/Core>

#include "paper/line_cloud.h"

namespace delio::picture {
/** The lines of a scan, coloured by height. Metres, sensor's frame. */
mrpt::opengl::COpenGLScene::Ptr lineScene(const paper::LineCloud& lines);

/** The lines of two scans, those of `from` in blue, those of `to` moved by `t` in red, and in
 *  green, 0.3 m above, what joins the midpoints of a pair. */
mrpt::opengl::COpenGLScene::Ptr matchScene(const paper::LineCloud& from, const paper::LineCloud& to,
                                           const Eigen::Vector3d& t);
}  // namespace delio::picture
