#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace mrpt::opengl {
class COpenGLScene;
}

namespace delio::picture {
/** Places of a scene that its picture has to show; metres, in the scene's frame. */
struct Content {
    std::vector<Eigen::Vector3d> points;  //!< a few of which may be strays
    std::vector<Eigen::Vector3d> lines;   //!< ends of lines: none is left out
    std::vector<Eigen::Vector3d> grids;   //!< corners: shown where they fall into the picture
    std::size_t cloudSize = 0;            //!< of all clouds of points, sampled or not
    bool empty() const { return points.empty() && lines.empty(); }
};

/** Of what is visible in the scene's main viewport; of large objects a sample. What was removed
 * from a map does not count, so that the map looks the same with and without it. */
Content contentOf(const mrpt::opengl::COpenGLScene& scene);
}  // namespace delio::picture
