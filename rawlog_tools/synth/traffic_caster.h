#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "ray_caster.h"
#include "sweep.h"
#include "traffic.h"

namespace delio::synth {
/** Casts rays on traffic. Every column of a sweep sees each road user where it is at the time that
 *  the column is fired: rays are brought into the road user's frame, so that its mesh never moves
 *  and nothing has to be built again. */
class TrafficCaster {
 public:
    explicit TrafficCaster(const Traffic& traffic);

    /** A road user as one sweep sees it. */
    struct View {
        std::size_t member;
        std::vector<std::uint32_t> columns;            //!< those that may hit it
        std::vector<Eigen::Isometry3d> lidarToMember;  //!< when each of them is fired
    };
    std::vector<View> viewsOf(const Sweep& sweep, double maxRange) const;

    /** Replaces hits that lie behind a road user. `local`: the directions of a ring's rays in the
     *  sensor's frame, one per column, as are the hits. May be called by several threads. */
    void cast(const View& view, const std::vector<Eigen::Vector3d>& local,
              std::vector<Hit>& hits) const;

 private:
    View viewOf(std::size_t member, const Sweep& sweep, double maxRange) const;

    const Traffic& traffic_;
    // All meshes in one scene, each in a place of its own, farther apart than they are large.
    RayCaster garage_;
};
}  // namespace delio::synth
