#pragma once
#include <Eigen/Geometry>

#include <cstddef>
#include <vector>

namespace delio::evaluation {
/** Angle of the rotation of `pose`, radians, 0 to pi: atan2(|skew part|, trace - 1) of the nearest
 *  rotation. The usual acos((trace - 1) / 2) loses half of the digits near 0, where the errors of
 *  an odometry lie. */
double rotationAngle_rad(const Eigen::Isometry3d& pose);

/** Segment of the drive from pose `first` to pose `last`, and the errors of the estimate on it. */
struct Segment {
    std::size_t first = 0;      //!< index of its first pose
    std::size_t last = 0;       //!< index of its last pose
    double length_m = 0;        //!< requested length; `last` is the first pose beyond it
    double t_percent = 0;       //!< translation error per length, in percent
    double r_deg_per_100m = 0;  //!< rotation error per length, in deg per 100 m
};

/** Mean errors over segments; NaN without segments. */
struct SegmentErrors {
    std::size_t segments = 0;   //!< that the means are over
    double t_percent = 0;       //!< translation error per length of the segment, in percent
    double r_deg_per_100m = 0;  //!< rotation error per length of the segment, in deg per 100 m
};

/** Unweighted mean over segments. */
SegmentErrors meanOf(const std::vector<Segment>& segments);

/** Mean errors of the segments of one length. */
struct LengthErrors : SegmentErrors {
    double length_m = 0;  //!< requested length of each segment
};

/** Mean errors over all segments, by length, and the segments. */
struct KittiErrors : SegmentErrors {
    std::vector<LengthErrors> perLength;  //!< one per length asked for, in that order
    std::vector<Segment> all;             //!< in order of their lengths
};

/** 100, 200, ... 800 m: what KITTI scores. */
std::vector<double> kittiLengths_m();

/** Distance travelled through the positions up to each pose, metres. */
std::vector<double> travelled_m(const std::vector<Eigen::Isometry3d>& poses);

/** Length of the path through the positions, metres. */
double pathLength_m(const std::vector<Eigen::Isometry3d>& poses);

/** Segment lengths for drives of `path_m` metres that are too short for KITTI's; empty without
 *  motion. */
std::vector<double> suggestedLengths_m(double path_m);

/** The metric of KITTI's development kit: relative errors over all segments of the given lengths,
 *  measured along the reference, that begin at every tenth pose. The means are over segments.
 *  Both trajectories have the same count of poses, of the same moving frame; their fixed frames
 *  may differ. The one change to the kit: rotationAngle_rad() in place of its acos. */
KittiErrors kittiErrors(const std::vector<Eigen::Isometry3d>& reference,
                        const std::vector<Eigen::Isometry3d>& estimate,
                        const std::vector<double>& lengths_m = kittiLengths_m());

/** Distances between positions after alignment, metres; NaN where there are no poses. */
struct AbsoluteError {
    double rmse_m = 0;  //!< root mean square
    double max_m = 0;   //!< largest
};

/** APE: the positions of the estimate are moved onto those of the reference by the best rigid
 *  motion (Umeyama, no scale), whatever their fixed frames are. Same count of poses in both. */
AbsoluteError absoluteError(const std::vector<Eigen::Isometry3d>& reference,
                            const std::vector<Eigen::Isometry3d>& estimate);

/** Distribution of a list of errors; NaN if it is empty. */
struct Spread {
    double rmse = 0;    //!< root mean square
    double median = 0;  //!< 50th percentile
    double p95 = 0;     //!< 95th percentile
    double max = 0;     //!< the largest
};

/** Of errors in any order, all finite. */
Spread spreadOf(std::vector<double> errors);

/** Errors of relative motions, and their distribution. */
struct RelativeError {
    std::vector<double> translations_m;  //!< entry i: of the motion from pose i to pose i + delta
    std::vector<double> rotations_deg;   //!< the same for its rotation
    Spread translation_m;                //!< of `translations_m`
    Spread rotation_deg;                 //!< of `rotations_deg`
};

/** RPE: errors of the relative motions over `delta` poses (1 or more). Same count of poses in
 *  both, of the same moving frame; their fixed frames may differ. */
RelativeError relativeError(const std::vector<Eigen::Isometry3d>& reference,
                            const std::vector<Eigen::Isometry3d>& estimate, std::size_t delta = 1);

/** Between poses of one fixed frame, such as a map's: nothing is aligned. Same count in both. */
struct PoseError {
    Spread translation_m;  //!< distances between the positions
    Spread rotation_deg;   //!< angles between the orientations
};
/** Of each pose of `estimate` beside that of `reference`. */
PoseError poseError(const std::vector<Eigen::Isometry3d>& reference,
                    const std::vector<Eigen::Isometry3d>& estimate);
}  // namespace delio::evaluation
