#pragma once
#include <Eigen/Geometry>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "delio/earth/coordinates.h"
#include "delio/earth/fix.h"

namespace delio::synth {
/** A GNSS receiver on the vehicle. */
struct GnssRequest {
    double sigma_m = 0;  //!< standard deviation, horizontally; twice of it in height
    double rate_hz = 5;  //!< fixes a second
    double jumps = 0;    //!< fraction of fixes that are wrong by kJump_m, some seconds at a time
    double gapFirst_s = 0, gapLast_s = 0;     //!< time without fixes
    Eigen::Vector3d antenna{-0.8, 0.3, 0.5};  //!< in the frame of the upright LiDAR, metres
    std::uint64_t seed = 1;
};

constexpr double kJump_m = 20;

/** Makes the fixes of a drive. The world lies on the earth at 49.0 N, 8.4 E, its x axis turned by
 *  35 degrees from east to north. */
class GnssReceiver {
 public:
    /** `lidarAt`: pose of the upright LiDAR in the world at a time in seconds.
     * `vehicleFromUpright`: from its frame to the vehicle's. */
    GnssReceiver(const GnssRequest& request,
                 std::function<Eigen::Isometry3d(double time_s)> lidarAt,
                 const Eigen::Isometry3d& vehicleFromUpright);

    /** Calls `take` with each fix up to a time, in their order. */
    void upTo(double time_s, const std::function<void(const earth::Fix& fix)>& take);

    /** As GGA numbers it. */
    int quality() const;

    /** The truth: a comment with the georeference of the map (whose frame is the vehicle's at time
     *  0) and a row per fix: the antenna's place and what the fix adds to it. */
    const std::string& truth() const { return truth_; }

 private:
    earth::Fix fixAt(std::size_t number);

    GnssRequest request_;
    std::function<Eigen::Isometry3d(double)> lidarAt_;
    Eigen::Isometry3d enuFromWorld_;
    Eigen::Vector3d antennaOfVehicle_;
    earth::EnuFrame enu_;
    std::size_t count_ = 0;
    std::string truth_;
};

/** Where synthetic worlds lie on the earth. */
earth::Geodetic originOfWorlds();
}  // namespace delio::synth
