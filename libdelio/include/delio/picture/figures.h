#pragma once
#include <mrpt/opengl/COpenGLScene.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "delio/picture/render.h"
#include "delio/run/run_folder.h"

namespace delio::picture {
/** Patterns of normals (unit vectors), each on a unit sphere of its own, side by side from left to
 *  right, coloured by their place on the sphere so that a pattern can be followed from one to the
 *  next; a caption each. In the axes of the sensor: x away from the viewer of sphereView(). */
mrpt::opengl::COpenGLScene::Ptr sphereScene(const std::vector<Eigen::Matrix3Xf>& patterns,
                                            const std::vector<std::string>& captions);

/** The spheres of sphereScene() as a reader of the paper looks at them: from behind and above. */
SnapshotOptions sphereView(std::size_t spheres);

/** The pictures of a run: map.3Dscene and map.png where there are points, map_removal.png
 *  where something dynamic was taken out of them, before (in red what was) beside after in the same
 *  view, and trajectory.png, from above; where the graph had something to optimise, before and
 * after it side by side. To be given to run::RunFolder::write(). Throws Error where one cannot be
 * drawn or written. */
void illustrate(const run::RunRecord& record, const map::BuiltMap& map,
                const run::RunFolder& folder);
}  // namespace delio::picture
