#pragma once
#include <Eigen/Geometry>

#include <cstddef>
#include <vector>

namespace delio::evaluation {
/** A stretch of the drive from pose `first` to pose `last`, and what the estimate got wrong on it.
 */
struct Segment {
    std::size_t first = 0;      //!< number of the pose that it begins with
    std::size_t last = 0;       //!< number of the pose that it ends with
    double length_m = 0;        //!< asked for; the last pose is the first one beyond it
    double t_percent = 0;       //!< translation error per length, in percent
    double r_deg_per_100m = 0;  //!< rotation error per length, in deg per 100 m
};

/** Mean errors of a number of segments; NaN where there is none. */
struct SegmentErrors {
    std::size_t segments = 0;   //!< that the means are over
    double t_percent = 0;       //!< translation error per length of the segment, in percent
    double r_deg_per_100m = 0;  //!< rotation error per length of the segment, in deg per 100 m
};

/** The plain mean over segments. */
SegmentErrors meanOf(const std::vector<Segment>& segments);

/** Mean errors of the segments of one length. */
struct LengthErrors : SegmentErrors {
    double length_m = 0;  //!< of each of them, as asked for
};

/** Mean errors of all segments, and what they are made of. */
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

/** Lengths that a drive of `path_m` metres has several segments of, for drives that are too short
 *  for KITTI's; empty where nothing moves. */
std::vector<double> suggestedLengths_m(double path_m);

/** The metric of KITTI's development kit: relative errors over all segments of the given lengths,
 *  measured along the reference, that begin at every tenth pose. The means are over segments.
 *  Both trajectories have the same count of poses, of the same moving frame; their fixed frames
 *  may differ. The one change to the kit: rotationAngle_rad() in place of its acos. */
KittiErrors kittiErrors(const std::vector<Eigen::Isometry3d>& reference,
                        const std::vector<Eigen::Isometry3d>& estimate,
                        const std::vector<double>& lengths_m = kittiLengths_m());
}  // namespace delio::evaluation
