#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace delio::odometry {
/** The ring (laser) of each point of a spinning LiDAR, from 0, for a cloud without ring
 *  numbers. Rings are the modes of the points' elevations, from the top, in any order of points.
 *  Elevations can be blurred: an HDL-64E's beams do not come from one point, and de-skewed points
 *  have moved. Rings that follow each other, as in KITTI's files, are then separated where the
 *  azimuth falls back by more than half a turn. A cloud without rings is cut into 64 equal steps of
 *  elevation. */
std::vector<std::uint16_t> ringsOf(const Eigen::Matrix3Xf& points);

/** The same rings numbered from the highest mean elevation (0) down, so that consecutive numbers
 *  are neighbours: Velodyne numbers its lasers in the order in which they fire. */
std::vector<std::uint16_t> ringsFromTop(const Eigen::Matrix3Xf& points,
                                        const std::vector<std::uint16_t>& rings);

/** The beams (lasers) of a spinning LiDAR from the elevations of its points in any
 *  order: cones about the z axis with a common tip there. */
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
}  // namespace delio::odometry
