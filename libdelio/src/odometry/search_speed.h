#pragma once
#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <vector>

#include "odometry/moving_scan.h"
#include "odometry/sectors.h"

namespace delio::odometry {
/** Points of a scan in each of some sectors about the sensor. */
struct Overlap {
    Sectors count = Sectors::Zero();    //!< all
    Sectors matched = Sectors::Zero();  //!< those that lie on other scans

    double share() const { return matched.sum() / std::max(count.sum(), 1.); }
};

/** The speed along an axis that single scans do not show. Two scans are no guide: a sensor's own
 *  rings lie on each other best where it stands. So a few scans are placed together at every
 *  speed. Relief, trunks and posts lie on each other at the right one alone: of the speeds at which
 *  more points do than at those about it, one stands out. */
class SpeedSearch {
 public:
    /** `most_mps`: the highest speed. Points lie on each other within `reach_m`. */
    SpeedSearch(double most_mps, double reach_m) : most_mps_(most_mps), reach_m_(reach_m) {}

    /** What is known before the scans are placed together. */
    struct Guess {
        Eigen::Vector3d axis;     //!< unit vector of the map's frame
        double speed_mps = 0;     //!< along the axis
        Eigen::Matrix3f upright;  //!< turns the sensor's z up
    };

    /** Takes a scan, which follows the latest one. After each few: the scans at the speed that fits
     *  clearly better than others, the last one where it was. Nothing where they show no speed.
     *  A group of scans is compared when the next group is complete, or at once where it may
     *  decide: most starts need no comparison, and one takes as long as ten scans. */
    std::optional<std::vector<MovingScan>> add(MovingScan scan, const Guess& guess);

    void clear();

 private:
    static constexpr std::size_t kTogether = 4;
    static constexpr unsigned kOften = 3;  //!< a speed that fits best so often is the right one

    /** kTogether scans, and the estimates after them. */
    struct Group {
        Eigen::Vector3d forward;  //!< unit vector of the sensor's frame, along which it moves
        double present_mps = 0;   //!< the speed that tracking has found
        Eigen::Matrix3f upright;  //!< turns the sensor's z up
    };
    using Scans = std::vector<MovingScan>;

    std::vector<Overlap> overlapsOf(const Group& group, Scans scans) const;
    double offsetOfPeak(Eigen::Index near) const;
    std::optional<double> compare(const Group& group, const Scans& scans);
    Scans groupBefore(std::size_t end) const;
    void forgetOld();

    double most_mps_, reach_m_;
    Scans scans_;                                     //!< since the same speed fits best
    std::optional<Group> waiting_;                    //!< is not compared yet
    Eigen::Vector3d axes_ = Eigen::Vector3d::Zero();  //!< sum of the axes, sensor's frame
    std::vector<Overlap> overlaps_;                   //!< at each speed, of all scans so far
    /** The speed that fits best. */
    struct Likely {
        double speed_mps = 0;
        unsigned times = 0;  //!< in a row
    };
    Likely likely_;
};
}  // namespace delio::odometry
