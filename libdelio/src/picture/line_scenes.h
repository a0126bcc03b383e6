#pragma once
#include <mrpt/opengl/COpenGLScene.h>

#include <Eigen/Core>

#include <vector>

#include "paper/line_cloud.h"
#include "paper/mean_shift.h"

namespace delio::picture {
/** Those of the lines with these numbers. */
paper::LineCloud someOf(const paper::LineCloud& lines, const std::vector<Eigen::Index>& which);

/** The lines of a scan, coloured by height. Metres, sensor's frame. */
mrpt::opengl::COpenGLScene::Ptr lineScene(const paper::LineCloud& lines);

/** The lines of two scans, those of `from` in blue, those of `to` moved by `t` in red, and in
 *  green, 0.3 m above, what joins the midpoints of a pair. */
mrpt::opengl::COpenGLScene::Ptr matchScene(const paper::LineCloud& from, const paper::LineCloud& to,
                                           const Eigen::Vector3d& t);

/** A level circle: seen from above, its middle is that of the view. */
void addCircle(mrpt::opengl::COpenGLScene& scene, const Eigen::Vector3d& middle, double radius_m);

/** A scan as a cloud, coloured by height above the ground; metres. */
mrpt::opengl::COpenGLScene::Ptr cloudScene(const Eigen::Matrix3Xf& points);

/** How lines are drawn in bins: points of the rings in grey, the outline of one bin in blue, lines
 *  that are kept in green, the others of those drawn in red. Metres, sensor's frame. */
mrpt::opengl::COpenGLScene::Ptr binScene(const Eigen::Matrix3Xf& points,
                                         const Eigen::Matrix3Xf& outline,
                                         const paper::LineCloud& drawn,
                                         const paper::LineCloud& kept);

/** Mean shift on three spheres of sphereScene(): normals with the seeds; with the windows (apex
 *  angle `window_deg`) at the modes; the pattern about the modes. */
mrpt::opengl::COpenGLScene::Ptr meanShiftScene(const Eigen::Matrix3Xf& normals,
                                               const Eigen::Matrix3Xf& seeds,
                                               const std::vector<paper::Mode>& modes,
                                               double window_deg, const Eigen::Matrix3Xf& pattern);

/** A scanner with the beams of one moment, directions from the top to the bottom. */
mrpt::opengl::COpenGLScene::Ptr scannerScene(const Eigen::Matrix3Xf& beams);
}  // namespace delio::picture
