#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "delio/core/odometry_options.h"

namespace delio::paper {
/** Line segments between points of neighbouring rings, one per column; metres, sensor's frame. */
struct LineCloud {
    Eigen::Matrix3Xf midpoints;   //!< metres
    Eigen::Matrix3Xf directions;  //!< unit vectors
    Eigen::VectorXf lengths;      //!< metres
    std::size_t drawn = 0;        //!< lines drawn, of which the shortest were kept
};

/** In each bin of the polar grid (two neighbouring rings, one sector of azimuth) `drawn` random
 *  lines are drawn from a point of one ring to a point of the other, and the `kept` shortest are
 *  kept: those lie on one surface. `rings`: ring of each point. The draw depends on the seed and
 *  the bin alone. */
LineCloud drawLines(const Eigen::Matrix3Xf& points, const std::vector<std::uint16_t>& rings,
                    const LineCloudOptions& options);

/** The lines turned about the sensor: the unrotated scan. */
LineCloud rotated(const LineCloud& lines, const Eigen::Matrix3d& R);
}  // namespace delio::paper
