#pragma once
#include "delio/odometry/plane_odometry_options.h"
#include "delio/odometry/scan_view.h"

namespace delio {
/** The latest scan that was registered. */
struct ReferenceScan {
    Eigen::Matrix3Xf points;                                 //!< sensor's frame
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< sensor to map
    double time_s = 0;                                       //!< stamp, seconds of the drive
};

/** What is known of a scan's place before it is registered. */
struct Expectation {
    const Eigen::Isometry3d& pose;   //!< predicted, sensor to map
    const ReferenceScan& reference;  //!< to search from where the prediction fails
    const Eigen::Matrix3f& upright;  //!< turns the sensor's z up
    bool motionIsKnown = false;      //!< else it may be anywhere within `start_m`
    bool isGuess = false;            //!< motion and place are not known well
    bool isShaken = false;           //!< predictions are off by more than the widest kernel
    double start_m = 0;              //!< how far a guess may be off, in the level plane
    double reach_m = 0;              //!< within which surfaces look for what points do not find
    double kernel_m = 0;             //!< how far predictions are off
    double usualShare = 0;           //!< of points on those of the map; 0: not known
};

/** What is known of a scan's place before planes refine it. */
struct Placement {
    points::PointEstimate estimate;  //!< sensor to map
    bool searched = false;           //!< from more starts than the prediction
};

/** By points, from the prediction; where that is not known, or fits worse than usual, from other
 *  starts too, and the one is taken where most points fit. */
Placement placeScan(const ScanToMap& map, const ScanView& view, const Expectation& expected,
                    const PlaneOdometryOptions& options);
}  // namespace delio
