#pragma once

#include "delio/core/odometry_options.h"
#include "odometry/local_map.h"
#include "odometry/register_planes.h"
#include "odometry/tuning.h"
#include "paper/normals.h"
#include "paper/pattern_registration.h"

namespace delio::odometry {
/** Overlap of a scan's surfaces with the map's at `pose` (sensor to map), 0 to 1: a surface counts
 *  where it meets a plane that looks the same way, within about `kernel` (metres). All directions
 *  count the same in all, so that the ground, which fits nearly anywhere, does not decide. */
double agreement(const PlaneMap& map, const paper::SurfaceNormals& surfaces,
                 const Eigen::Isometry3d& pose, double kernel);

/** Global search: where a scan of known rotation lies best within `radius` (metres, horizontally)
 *  of `centre` (sensor to map): the agreement of starts all over that disc is compared, and the
 *  best are registered. For a prediction that is off by metres. `surfaces`: of the same scan. */
PlaneEstimate searchInPlanes(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                             const paper::SurfaceNormals& surfaces, const Eigen::Isometry3d& centre,
                             double radius, const PlaneRegistrationOptions& options);

/** Finds a scan again in the map of planes where the prediction is off by metres: rotation first,
 * by the paper's way, which no translation can disturb (the pattern of this scan's normals on that
 * of a `reference` scan), then a global search of the place within `radius` metres.
 *  @param reference surfaces of a scan whose pose in the map is `referencePose` (sensor to map)
 *  @param points, surfaces of the scan that is sought, in its sensor's frame
 *  @param guess sensor to map */
PlaneEstimate relocalise(const PlaneMap& map, const paper::SurfaceNormals& reference,
                         const Eigen::Isometry3d& referencePose, const Eigen::Matrix3Xd& points,
                         const paper::SurfaceNormals& surfaces, const Eigen::Isometry3d& guess,
                         double radius, const PlaneRegistrationOptions& options,
                         const PatternRegistrationOptions& pattern);

/** The latest scan that was registered. */
struct ReferenceScan {
    Eigen::Matrix3Xf points;                                 //!< sensor's frame
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< sensor to map
    double time_s = 0;                                       //!< stamp, seconds of the drive
    bool isBeforePause = false;  //!< how much time has passed since is not known
};

/** What is known of a scan's place before it is registered. */
struct Expectation {
    Eigen::Isometry3d pose;           //!< predicted, sensor to map
    const ReferenceScan& reference;   //!< to search from where the prediction fails
    const Eigen::Matrix3f& upright;   //!< turns the sensor's z up
    bool motionIsKnown = false;       //!< else it may be anywhere within `start`
    bool isGuess = false;             //!< motion and place are not known well
    bool isUrgent = false;            //!< no time for the searches that take longest
    bool isShaken = false;            //!< predictions are off by more than the widest kernel
    bool isPlacedByStanding = false;  //!< points that stand above the ground place the scan
    SearchReach start = {};           //!< how far a guess may be off
    double reach_m = 0;               //!< within which surfaces look for what points do not find
    double kernel_m = 0;              //!< how far predictions are off
    double usualInlierRatio = 0;      //!< of points on those of the map; 0: not known

    static constexpr double kLikely = 0.75, kLikelyAtFirst = 0.25;
    /** A pose is likely where so many points fit. */
    double likelyInlierRatio() const {
        return usualInlierRatio > 0 ? kLikely * usualInlierRatio : kLikelyAtFirst;
    }
};

/** What is known of a scan's place before planes refine it. */
struct Placement {
    PointEstimate estimate;  //!< sensor to map
    bool searched = false;   //!< from more starts than the prediction
    bool isLikely = false;   //!< about as many points fit as usual
};

/** By points, from the prediction; where that is a guess, from other starts too, and the one is
 *  taken where most points fit. */
Placement placeScan(const LocalMap& map, const ScanView& view, const Expectation& expected,
                    const ScaledOptions& options);
}  // namespace delio::odometry
