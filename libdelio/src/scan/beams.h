#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace delio::scan {
/** The beams (lasers) of a spinning LiDAR as the elevations of its points tell of them, whatever
 *  the points' order: cones about the z axis with a common tip there. */
struct Beams {
    float height = 0;               //!< of the tip, m
    std::vector<float> elevations;  //!< rad, from the top
    /** How far points lie from their beam, a mean share of the way to the next one: 0 where they
     *  lie on it, about 1/4 where they lie anywhere. */
    double blur = 1;
};

/** Elevation of a point seen from that height above the origin, rad. */
float elevationFrom(float height, const Eigen::Vector3f& point);

/** The modes of the elevations seen from `height`. */
Beams beamsFrom(const Eigen::Matrix3Xf& points, float height);

/** From the height within 0.3 m where they are least blurred: the beams of an HDL-64E meet 0.2 m
 *  above the origin of KITTI's scans, which at 10 m is three times what lies between them. */
Beams beamsFromAnyHeight(const Eigen::Matrix3Xf& points);

/** The beam next to each point, counted from the top. */
std::vector<std::uint16_t> nearestBeams(const Eigen::Matrix3Xf& points, const Beams& beams);
}  // namespace delio::scan
