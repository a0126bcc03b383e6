#include "delio/loops/sketch.h"

#include <cmath>

#include "core/voxel_grid.h"
#include "odometry/plane_map.h"

namespace delio::loops {
namespace {
/** Of a levelled cloud a normal a voxel that is flat, which says as much as it has points. (Normals
 *  about each point, from nearest neighbours, found no other loops, and took eight times the
 *  instructions.) */
paper::SurfaceNormals wallsOf(const Eigen::Matrix3Xf& points) {
    PlaneMapOptions options;
    options.voxel_size = 1;
    options.levels = 1;
    options.ground_levels = 0;
    options.min_points = 5;
    options.max_flatness = 0.02;  // thickness a seventh of the breadth
    options.min_breadth = 0.1;
    odometry::PlaneMap map(options);
    map.add(points.cast<double>());
    const Eigen::Matrix3Xf firsts = firstOfVoxels(points, options.voxel_size);
    paper::SurfaceNormals walls;
    walls.directions.resize(3, firsts.cols());
    walls.planarity.resize(firsts.cols());
    Eigen::Index kept = 0;
    for (Eigen::Index i = 0; i < firsts.cols(); ++i) {
        const odometry::Plane* plane = map.at(firsts.col(i).cast<double>());
        if (!plane) continue;
        const double thickness = std::sqrt(plane->variances[0] / plane->variances[1]);
        walls.directions.col(kept) = plane->normal().cast<float>();
        walls.planarity[kept] = static_cast<float>((1 - thickness) * plane->count);
        ++kept;
    }
    walls.directions.conservativeResize(3, kept);
    walls.planarity.conservativeResize(kept);
    return walls;
}
}  // namespace

Sketch::Sketch(const Eigen::Matrix3Xf& points) : azimuths(wallsOf(points)), image(points) {}
}  // namespace delio::loops
