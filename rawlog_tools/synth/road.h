#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "lane.h"
#include "line_index.h"
#include "motion.h"
#include "path.h"
#include "road_profile.h"
#include "terrain.h"

namespace delio::synth {
/** The ground around the vehicle's path. Sideways places are measured from the road's centre line,
 *  positive to the left; the vehicle keeps right of it. Where the path comes back to a road that is
 *  there already, no second one is built: a stretch of road belongs to the first part of the path
 *  that runs along it. The height of the ground depends on the place alone. */
class Road {
 public:
    // Of a street in a town.
    static constexpr double kLaneEdge_m = 3.3;     //!< parked cars stay outside
    static constexpr double kKerb_m = 5.5;         //!< all else stays outside
    static constexpr double kSidewalkEnd_m = 8.7;  //!< facades stay outside
    /** Farther than that from a road, nothing is known about it. */
    static constexpr double kReach_m = 64;

    Road(Path path, std::uint64_t seed, RoadProfile profile = urbanProfile());
    /** The vehicle moves as given; the path has to be its path. */
    Road(Path path, std::uint64_t seed, RoadProfile profile, std::shared_ptr<const Motion> motion);

    const Path& path() const { return path_; }
    const RoadProfile& profile() const { return profile_; }
    /** None: as the profile's style has it. */
    const Motion* givenMotion() const { return motion_.get(); }
    /** The vehicle's own is the first. */
    const std::vector<Lane>& lanes() const { return profile_.lanes; }
    double vehicleSide() const { return profile_.lanes.front().side_m; }

    /** Seen from above, at `side_m` from the centre line. */
    Eigen::Vector2d point(double s, double side_m) const;
    /** From the nearest centre line. */
    LineIndex::Nearest nearest(const Eigen::Vector2d& place) const {
        return centres_.nearest(place, kReach_m);
    }
    /** The same; kReach_m: more than that. */
    double distance(const Eigen::Vector2d& place) const { return nearest(place).distance; }
    /** From the nearest place where the middle of the vehicle passes, at any time of the drive;
     *  `reach_m`: more than that. */
    double distanceToVehicle(const Eigen::Vector2d& place, double reach_m) const {
        return tracks_.nearest(place, reach_m).distance;
    }
    /** False where an earlier part of the path runs along the same road. */
    bool owns(double s) const;
    /** Height of the ground. */
    double height(const Eigen::Vector2d& place) const { return height(place, distance(place)); }
    /** The same where it is known how far `place` is from the nearest road. */
    double height(const Eigen::Vector2d& place, double away_m) const;
    /** The parts of the path that own a road within `reach_m` of `place`, by their stations. */
    std::vector<double> stationsNear(const Eigen::Vector2d& place, double reach_m) const;

 private:
    void buildIndices();

    Path path_;
    RoadProfile profile_;
    Terrain terrain_;
    std::shared_ptr<const Motion> motion_;
    std::vector<char> owned_;  // every metre from path_.begin()
    LineIndex centres_, tracks_;
};
}  // namespace delio::synth
