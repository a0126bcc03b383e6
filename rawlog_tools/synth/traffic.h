#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "drive.h"
#include "random.h"
#include "road_user.h"

namespace delio::synth {
/** Traffic. On a road for cars: in the vehicle's own lane others accompany it, the nearest ones at
 *  4 to 10 m for the whole drive (for a scan-to-scan method such a car stands still); in every
 *  other lane traffic flows freely; where traffic is slow there are cyclists at the edge and
 *  pedestrians on the sidewalk. Elsewhere there are pedestrians only. Road users that fall behind
 *  or gets ahead by more than reach() comes again from the other end. A place is a closed formula
 *  of time (and of the vehicle's own place): it depends on nothing that was asked before. *  Nobody
 *  collides: all in a lane go at one speed, or keep to the vehicle's own station, with room between
 *  them. */
class Traffic {
 public:
    /** Metres along the road, ahead and behind: what lies beyond is seen by no sensor on a road
     * that does not turn back. */
    static constexpr double kReach_m = 180;
    /** The same where the road comes back to itself, round a block or after a turn: less than half
     *  of the shortest way round, so that those of one round do not meet those of the next; but not
     *  below kLeastReach_m, so that on a drive that turns back at once some may meet. */
    static constexpr double kLeastReach_m = 60;

    /** `count` of them; more than the lanes hold with room between them are left out. */
    Traffic(const Road& road, const Drive& drive, std::size_t count, std::uint64_t seed);

    double reach() const { return reach_m_; }
    std::size_t size() const { return members_.size(); }
    RoadUserKind kind(std::size_t member) const;
    const RoadUser& looks(std::size_t member) const { return members_[member].looks; }
    /** Maps the member's frame (see RoadUser) to the world. */
    Eigen::Isometry3d pose(std::size_t member, double time_s) const;
    /** Metres along the road from the vehicle to the member, positive ahead. */
    double ahead(std::size_t member, double time_s) const;
    /** It keeps its place before or behind the vehicle. */
    bool accompanies(std::size_t member) const;

 private:
    /** A stripe of the road on which all go at one speed. */
    struct Stripe {
        RoadUserKind kind;
        double side_m;
        int direction;
        double speed_m_s;   //!< of free traffic
        double wave_m = 0;  //!< companions swing to and fro once in so many metres; 0: free
        double share = 1;   //!< of all members, against the other stripes'
        std::size_t members = 0;
    };
    struct Member {
        std::size_t stripe;
        double ahead_m;  //!< in a free stripe at time 0, of a companion on average
        double swing_m, phase;
        double sway_m;  //!< sideways
        RoadUser looks;
    };

    static std::vector<Stripe> footwaysOf(const Road& road, Random random);
    static std::vector<Stripe> stripesOf(const Road& road, Random random);
    std::size_t nextStripe() const;
    Member makeMember(std::size_t stripe, std::size_t number) const;

    const Road& road_;
    const Drive& drive_;
    std::uint64_t seed_;
    double reach_m_;
    std::vector<Stripe> stripes_;
    std::vector<Member> members_;
};
}  // namespace delio::synth
