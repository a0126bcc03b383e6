#pragma once
#include <Eigen/Geometry>

#include <cstddef>
#include <string>
#include <vector>

#include "delio/core/error.h"
#include "delio/evaluation/metrics.h"
#include "delio/formats/scan_table.h"
#include "delio/formats/trajectory.h"

namespace delio::evaluation {
/** Two trajectories pose by pose: `reference[i]` and `estimate[i]` belong together. */
struct Association {
    std::vector<Eigen::Isometry3d> reference;  //!< poses of the reference that have a partner
    std::vector<Eigen::Isometry3d> estimate;   //!< their partners
    std::vector<std::size_t>
        estimateRows;                    //!< estimate[i] is row estimateRows[i] of what was given
    std::vector<double> stamps_s;        //!< of the pairs; empty where neither file has stamps
    std::size_t unmatchedReference = 0;  //!< poses of the reference without a partner
    std::size_t unmatchedEstimate = 0;   //!< the same of the estimate
};

/** Where both have stamps, poses belong together that are each other's nearest in time and at most
 *  `tolerance_s` seconds apart (so the order of time is kept, and no pose is used twice).
 *  Otherwise rows belong together. Stamps have to rise.
 *  Throws Error where rows are to be matched and their counts differ, or where no stamps match. */
Association associate(const io::Trajectory& reference, const io::Trajectory& estimate,
                      double tolerance_s = 0.02);

/** Do the two trajectories belong to the same moving frame? LiDAR: x forward, y left, z up.
 *  Camera: z forward, x right, y down. */
enum class FrameMismatch {
    none,
    lidarAgainstCamera,  //!< estimate's axes are a LiDAR's, the reference's a camera's
    cameraAgainstLidar,  //!< the reverse, or an estimate turned from LiDAR to camera twice
    unknown              //!< the path is too short to tell
};

/** Compares the directions in which the moving frames travel, metre by metre (of paths below 6 m a
 *  sixth of the path, at least 0.2 m). A mismatch is reported only where the directions disagree as
 *  they stand (mean cosine below 0.5) and agree after the axes are swapped (above 0.9): a bad
 *  estimate is no mismatch. `unknown`: there are fewer than three such steps, and they do not
 *  agree as they stand. Same count of poses in both. */
FrameMismatch findFrameMismatch(const std::vector<Eigen::Isometry3d>& reference,
                                const std::vector<Eigen::Isometry3d>& estimate);

/** True if the moving frame travels along its own z, as a camera does, rather than along x. */
bool movesAlongZ(const std::vector<Eigen::Isometry3d>& poses);

/** The figures of one estimate on one sequence. NaN: not available, printed as '-'. */
struct ReportRow {
    std::string name;      //!< of the estimate
    std::string sequence;  //!< "avg" in a row of averages
    double length_m = 0;   //!< of the reference's path
    KittiErrors kitti;     //!< over KITTI's segments
    double ape_m = 0;      //!< RMSE after rigid alignment
    double rpe_m = 0;      //!< RMSE
    double rpe_deg = 0;    //!< RMSE
};

/** Scores an estimate pose by pose: every metric of a row. */
ReportRow score(const std::vector<Eigen::Isometry3d>& reference,
                const std::vector<Eigen::Isometry3d>& estimate,
                const std::vector<double>& lengths_m, std::size_t delta);

/** The row "avg" as papers on KITTI give it: the plain mean of the sequences' errors, however long
 *  they are; lengths and counts of segments are summed. A figure that a sequence does not have is
 *  left out of its mean. `rows` is not empty. */
ReportRow averageOf(const std::vector<ReportRow>& rows);

/** A warning where many of these true poses (cam0, metres) are known to be wrong, else empty.
 *  Known are KITTI's official poses of the first 16 scans of sequence 00: they extrapolate one
 *  speed, 0.86 m a scan, where every odometry finds less. They are recognised by their positions,
 *  wherever they are in the file. `many`: more than 5 % of all. */
std::string knownFaultOf(const std::vector<Eigen::Isometry3d>& reference);

/** One estimate on one sequence, pose by pose: `reference[i]`, `estimate[i]`, `times_s[i]` and
 *  `predicted[i]` belong together. */
struct Comparison {
    ReportRow row;                             //!< without its names, which are the caller's to set
    std::vector<Eigen::Isometry3d> reference;  //!< true poses
    std::vector<Eigen::Isometry3d> estimate;   //!< their partners
    std::vector<double> times_s;               //!< since the first pose
    bool timesAreAssumed = false;   //!< no file has times: ten poses a second, as KITTI has it
    std::vector<bool> predicted;    //!< scans that were not registered; empty where not known
    RelativeError perScan;          //!< of the motion from each pose to the next
    bool framesAreUnknown = false;  //!< the path is too short to tell whether both are of one frame
    std::string referenceFault;     //!< a warning that true poses are known to be wrong, or empty
    std::string mapPage;     //!< path of a page with the estimate's map; empty: there is none
    double end_error_m = 0;  //!< between the last poses, each seen from the first of its trajectory
    std::size_t unusedReference = 0;     //!< rows of the reference for scans that were not used
    std::size_t unmatchedReference = 0;  //!< poses of the reference (unused ones apart) and of the
    std::size_t unmatchedEstimate = 0;   //!< estimate without a partner in time

    /** The end error by the length of the true path; NaN where that stands still (below 0.1 m). */
    double endError_percent() const;
};

/** What compare() is asked for. */
struct ComparisonSettings {
    /** Of KITTI's segments. Empty: kittiLengths_m(), or suggestedLengths_m() where the path is
     *  shorter than twice the first of them. */
    std::vector<double> lengths_m;
    std::size_t delta = 1;  //!< poses that `rpe_m` and `rpe_deg` of the row span
};

/** The two trajectories are of different moving frames. */
class WrongFrames : public Error {
 public:
    /** With a message that says which, and what to do. */
    explicit WrongFrames(FrameMismatch found);
    FrameMismatch mismatch() const { return mismatch_; }  //!< which way round

 private:
    FrameMismatch mismatch_;
};

/** Finds the poses that belong together and scores them. `scans`: a row for each pose of the
 *  estimate. Where the reference has no stamps (KITTI), its rows belong to the scans of the rawlog,
 *  of which not all may have been used: then those that `scans` has are kept, unless the rows are
 *  as many as the poses of the estimate.
 *  A single pair is enough, though it has no motion. Throws WrongFrames, and Error where no pairs
 *  are found, or where the reference has no row for the last scan. */
Comparison compare(io::Trajectory reference, const io::Trajectory& estimate,
                   const ComparisonSettings& settings, const io::ScanTable* scans = nullptr);
}  // namespace delio::evaluation
