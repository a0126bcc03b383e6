#pragma once
#include <mrpt/img/TColor.h>
#include <mrpt/maps/CPointsMap.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/poses/CPose3D.h>

#include <string>
#include <vector>

#include "delio/map/colormap.h"

namespace delio::map {
struct SceneOptions {
    Colormap colormap = Colormap::Turbo;
    float pointSize_px = 2;
    mrpt::img::TColor background{16, 18, 22};
};

/** A map and the way through it, in the world's frame (metres, z up): points coloured by their
 *  height above the ground around them, the trajectory in white (on a light background: black) with
 *  a green mark at its start and a red one at its end, and a grid whose step is written into the
 *  corner. `poses` may be empty. Throws Error if there are no points. */
mrpt::opengl::COpenGLScene::Ptr mapScene(const mrpt::maps::CPointsMap& points,
                                         const std::vector<mrpt::poses::CPose3D>& poses,
                                         const SceneOptions& options = {});

/** Trajectories alone, on white: the estimate in blue, under the name given, and, if it is given,
 *  the ground truth in red, with a grid. Both in the same frame. Made to be seen from above: the
 * ground truth is drawn wider and is moved down until all of it is below the estimate, so that
 * neither hides the other. Throws Error if there are no poses. */
mrpt::opengl::COpenGLScene::Ptr trajectoryScene(
    const std::vector<mrpt::poses::CPose3D>& estimate,
    const std::vector<mrpt::poses::CPose3D>& groundTruth = {},
    const std::string& name = "estimate");

/** Writes a .3Dscene for SceneViewer3D. Throws Error if that fails. */
void saveScene(const mrpt::opengl::COpenGLScene& scene, const std::string& path);

/** Throws Error for a file that is missing, no scene, or cut off. */
mrpt::opengl::COpenGLScene::Ptr loadScene(const std::string& path);
}  // namespace delio::map
