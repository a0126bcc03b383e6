#pragma once
#include <mrpt/obs/CObservation.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>

#include <memory>
#include <optional>
#include <string>

#include "delio/odometry/odometry.h"
#include "delio/places/localisation.h"
#include "delio/places/stored_map.h"
#include "delio/slam/slam.h"

namespace delio {
class MapFollower;

/** Result of a Localiser for one scan. */
struct Localisation {
    Step step;   //!< of the odometry
    MapFix fix;  //!< pose in the map
};

/** Localises a vehicle in a stored map, scan by scan. Its size does not grow with the number of
 *  scans: it keeps no trajectory. */
class Localiser {
 public:
    /** `options`: of the odometry that goes before. Error where they contradict each other. */
    explicit Localiser(std::shared_ptr<const StoredMap> map, const OdometryOptions& options = {},
                       const PlaceSearchOptions& search = {},
                       const LocalisationOptions& localisation = {});

    /** Sets the approximate pose of the vehicle at the next scan (vehicle to map frame), accurate
     *  to a few metres; only its surroundings are searched. */
    void expect(const Eigen::Isometry3d& vehicle);

    /** The next scan. Error where the odometry fails, as in Slam::process(), and from the first
     * scan on that could not be compared with the map. */
    Localisation process(const Scan& scan);

    /** The same with MRPT's types: takes a LiDAR observation with its time stamp (see
     *  io::decodeObservation) and returns the vehicle's pose in the map's frame, or nothing while
     *  it is not localised. Throws Error for an observation that is not a LiDAR scan. */
    std::optional<mrpt::poses::CPose3DPDFGaussian> process(
        const mrpt::obs::CObservation& observation);

 private:
    std::shared_ptr<MapFollower> follower_;
    Slam slam_;
    std::size_t observations_ = 0;
    std::string fault_;  //!< of the follower; empty: none
};
}  // namespace delio
