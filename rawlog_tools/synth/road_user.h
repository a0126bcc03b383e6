#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "mesh.h"
#include "pose_on_road.h"

namespace delio::synth {
enum class RoadUserKind { kCar, kCyclist, kPedestrian };

/** The shape of something that moves. Its frame: the origin on the ground in the middle, x ahead,
 *  y left, z up. */
struct RoadUser {
    Mesh mesh;
    Eigen::AlignedBox3d box;  //!< what the mesh fills
    Footprint footprint;      //!< of its wheels or feet
};

/** One of a kind; another number, another car (one in seven is a van) or person. */
RoadUser makeRoadUser(RoadUserKind kind, std::uint64_t number);

/** No road user is longer or wider than these, in metres. */
double longest_m(RoadUserKind kind);
double widest_m(RoadUserKind kind);
}  // namespace delio::synth
