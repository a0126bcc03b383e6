#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "delio/points/point_map.h"

namespace delio::points {
/** A point of a scan, by its place in the order, with the nearest one of the map. */
struct Pair {
    Eigen::Index point = 0;
    Eigen::Vector3d inMap = Eigen::Vector3d::Zero();
    double squaredDistance = 0;
    double weight = 0;  //!< 0: none
};
using Pairs = std::vector<Pair>;

/** Pairs of a scan's points, again and again at poses that differ little: a point is looked for
 *  again only where it has moved so far that another one of the map may be the nearest. */
class Pairing {
 public:
    /** Map and points (the sensor's frame) have to stay as they are. */
    Pairing(const PointMap& map, const Eigen::Matrix3Xd& points);

    /** Of each `every`-th point. `kernel`: metres; pairs are at most three of them apart. */
    Pairs at(const Eigen::Isometry3d& pose, double kernel, Eigen::Index every = 1);

    const Eigen::Matrix3Xd& points() const { return points_; }

 private:
    /** What was found of a point, and where it was then. */
    struct Latest {
        PointMap::Nearest nearest;
        Eigen::Vector3d at = Eigen::Vector3d::Zero();
    };
    static constexpr std::size_t kBlock = 64;
    static bool isStill(const Latest& latest, const Eigen::Vector3d& placed, double reach);
    void pairBlock(const Eigen::Isometry3d& pose, double kernel, Eigen::Index first,
                   Eigen::Index every, Pair* pairs, std::size_t count);

    const PointMap& map_;
    const Eigen::Matrix3Xd& points_;
    std::vector<Latest> latest_;
};
}  // namespace delio::points
