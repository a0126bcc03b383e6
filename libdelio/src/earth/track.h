#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <string>
#include <vector>

#include "delio/earth/fix.h"
#include "delio/earth/georeference.h"

namespace delio::earth {
/** A fix at a pose of the vehicle. */
struct FixOnTrack {
    Fix fix;
    std::size_t node = 0;  //!< pose nearest in time
    /** The antenna in the frame of that pose, metres: its lever arm moved along the track to the
     *  time of the fix. */
    Eigen::Vector3d antenna = Eigen::Vector3d::Zero();
};

/** Poses of a vehicle at rising stamps; `usable`: false for a pose that was only predicted. */
struct Track {
    std::vector<Eigen::Isometry3d> poses;
    std::vector<double> stamps_s;
    std::vector<bool> usable;
};

/** The usable fixes between two successive poses that are both usable and at most a second apart,
 *  in the order of their times. An antenna that is not known is at the vehicle's origin. */
std::vector<FixOnTrack> fixesOn(const Track& track, Fixes fixes);

/** How a map was fitted to fixes, or why it was not. */
struct TrackFit {
    Georeference place;        //!< its origin is the map's
    std::string refusal;       //!< why it is not known; empty: it is
    std::vector<bool> inlier;  //!< of each fix
    double rms_m = 0;          //!< distance of inliers from their places, horizontally
    double rmsUp_m = 0;        //!< the same in height
    /** Standard deviations of the fixes over those that they claim, at least 1: with the drift of
     *  the track. */
    double scale = 1;
    double heading_deg = 0, headingSigma_deg = 0;  //!< of the map's x axis
};

/** Fits one rigid transformation from the map to east, north, up: hypotheses of two fixes each
 *  (least median of squares), then Gauss-Newton under Geman and McClure's kernel. The mean z axis
 *  of the poses is up to within 10 degrees (standard deviation), which decides only the roll about
 *  a straight track. Refused where the fixes are too few, the track is too short for their
 *  uncertainty, or the heading is not known to 3 degrees. The same input gives the same bytes. */
TrackFit fitTrack(const std::vector<FixOnTrack>& fixes,
                  const std::vector<Eigen::Isometry3d>& poses);
}  // namespace delio::earth
