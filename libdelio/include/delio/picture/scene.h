#pragma once
#include <mrpt/img/TColor.h>
#include <mrpt/maps/CPointsMap.h>
#include <mrpt/opengl/COpenGLScene.h>

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "delio/map/colouring.h"
#include "delio/map/map_point.h"

namespace delio::picture {
using map::ColourBy;

/** Style of a map. */
struct SceneOptions {
    map::Colormap colormap = map::Colormap::Turbo;  //!< of everything but normals
    ColourBy colourBy = ColourBy::Height;           //!< quantity shown by the colours
    float pointSize_px = 2;                         //!< in a picture of 1080 lines
    mrpt::img::TColor background{16, 18, 22};       //!< behind everything
    std::string caption = {};                       //!< a line of the legend
};

/** Trajectories in a map, as poses in the frame of its points; each may be empty. */
struct MapWays {
    std::vector<Eigen::Isometry3d> trajectory;   //!< in white
    std::vector<Eigen::Isometry3d> groundTruth;  //!< in red
    std::vector<Eigen::Isometry3d> keyframes;    //!< axes
    /** Poses of the trajectory, by number, between which a loop was closed. */
    std::vector<std::pair<std::size_t, std::size_t>> loops;
    std::vector<std::vector<Eigen::Isometry3d>> others = {};  //!< of other drives, drawn alike
    std::optional<Eigen::Vector3d> north = {};                //!< its direction, where it is known
};

/** A map and the ways through it, in the world's frame (metres, z up): points coloured by their
 *  height above the ground around them or by what else is known of them; the trajectory in white
 * (on a light background: black) with a green mark at its start and a yellow one at its end; the
 * ground truth in red, drawn wider and 0.2 to 1.2 m lower so that neither hides the other; axes at
 * the keyframes (x red, y green, z blue); closed loops in orange; a grid; and a legend in the lower
 * left corner. Throws Error if there are no points, or they do not have what they are to be
 *  coloured by. */
mrpt::opengl::COpenGLScene::Ptr mapScene(const map::MapPoints& points, const MapWays& ways,
                                         const SceneOptions& options = {});
/** The same for a cloud; only the fields set by pointsOf() are used. */
mrpt::opengl::COpenGLScene::Ptr mapScene(const mrpt::maps::CPointsMap& points, const MapWays& ways,
                                         const SceneOptions& options = {});

/** Adds removed dynamic points to a mapScene(), in red. Views that fill the picture stay the same.
 */
void addRemoved(mrpt::opengl::COpenGLScene& scene, const map::MapPoints& removed);

/** Gives a scene's coloured clouds, each by height above its ground, and the legend of mapScene()
 *  the colours of another colour map. Throws Error if the scene has no such cloud. */
void recolour(mrpt::opengl::COpenGLScene& scene, map::Colormap colormap);

/** Removes the points of a scene's coloured clouds that lie more than `height` metres above the
 *  ground around them, as map::cutAbove() does. */
void cutAbove(mrpt::opengl::COpenGLScene& scene, double height);

/** Trajectories alone, on white: `ways.trajectory` in blue, under the name given, with its loops in
 *  orange, and, if it is given, the ground truth in red, with a grid. Both in the same frame. Made
 * to be seen from above: the ground truth is drawn wider and is moved down until all of it is below
 * the estimate, so that neither hides the other. Throws Error if there are no poses. */
mrpt::opengl::COpenGLScene::Ptr trajectoryScene(const MapWays& ways,
                                                const std::string& name = "estimate");

/** Writes a .3Dscene for SceneViewer3D. Throws Error if that fails. */
void saveScene(const mrpt::opengl::COpenGLScene& scene, const std::string& path);

/** Throws Error for a file that is missing, no scene, or cut off. */
mrpt::opengl::COpenGLScene::Ptr loadScene(const std::string& path);
}  // namespace delio::picture
