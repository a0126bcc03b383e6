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
/** Matched poses of two trajectories: `reference[i]` and `estimate[i]` correspond. */
struct Association {
    std::vector<Eigen::Isometry3d> reference;  //!< poses of the reference with a counterpart
    std::vector<Eigen::Isometry3d> estimate;   //!< the counterparts
    std::vector<std::size_t>
        estimateRows;                    //!< estimate[i] is row estimateRows[i] of what was given
    std::vector<double> stamps_s;        //!< of the pairs; empty if neither file has stamps
    std::size_t unmatchedReference = 0;  //!< unmatched poses of the reference
    std::size_t unmatchedEstimate = 0;   //!< the same of the estimate
};

/** Matches poses by time if both have stamps: mutual nearest neighbours at most `tolerance_s`
 *  seconds apart (so the order is kept and no pose is used twice). Otherwise matches rows. Stamps
 *  must increase. Throws Error if rows are matched and their counts differ, or if no stamps match.
 */
Association associate(const io::Trajectory& reference, const io::Trajectory& estimate,
                      double tolerance_s = 0.02);

/** Whether two trajectories describe the same moving frame. LiDAR: x forward, y left, z up. Camera:
 *  z forward, x right, y down. */
enum class FrameMismatch {
    none,
    lidarAgainstCamera,  //!< estimate's axes are a LiDAR's, the reference's a camera's
    cameraAgainstLidar,  //!< the reverse, or an estimate turned from LiDAR to camera twice
    unknown              //!< the path is too short to decide
};

/** Compares the directions in which the moving frames travel, metre by metre (of paths below 6 m a
 *  sixth of the path, at least 0.2 m). A mismatch is reported only if the directions disagree (mean
 *  cosine below 0.5) and agree after swapping the axes (above 0.9), so a bad estimate is not a
 *  mismatch. `unknown`: fewer than three steps that disagree. Same count of poses in both. */
FrameMismatch findFrameMismatch(const std::vector<Eigen::Isometry3d>& reference,
                                const std::vector<Eigen::Isometry3d>& estimate);

/** True if the moving frame travels along its own z, as a camera does, rather than along x. */
bool movesAlongZ(const std::vector<Eigen::Isometry3d>& poses);

/** Errors of one estimate on one sequence. NaN: not available, printed as '-'. */
struct ReportRow {
    std::string name;      //!< of the estimate
    std::string sequence;  //!< "avg" in a row of averages
    double length_m = 0;   //!< of the reference's path
    KittiErrors kitti;     //!< over KITTI's segments
    double ape_m = 0;      //!< RMSE after rigid alignment
    double rpe_m = 0;      //!< RMSE
    double rpe_deg = 0;    //!< RMSE
};

/** Computes all metrics of an estimate with matched poses. */
ReportRow score(const std::vector<Eigen::Isometry3d>& reference,
                const std::vector<Eigen::Isometry3d>& estimate,
                const std::vector<double>& lengths_m, std::size_t delta);

/** Row "avg" as in papers on KITTI: unweighted mean over sequences; lengths and numbers of segments
 *  are summed. Missing values are ignored. `rows` is not empty. */
ReportRow averageOf(const std::vector<ReportRow>& rows);

/** Warning if many of these ground-truth poses (cam0, metres) are known to be wrong, else empty.
 *  Known are KITTI's official poses of the first 16 scans of sequence 00, which extrapolate one
 *  speed, 0.86 m per scan. They are recognised by their positions, anywhere in the file. `many`:
 *  more than 5 % of all. */
std::string knownFaultOf(const std::vector<Eigen::Isometry3d>& reference);

/** One estimate on one sequence, pose by pose: `reference[i]`, `estimate[i]`, `times_s[i]` and
 *  `predicted[i]` belong together. */
struct Comparison {
    ReportRow row;                             //!< without its names, which are the caller's to set
    std::vector<Eigen::Isometry3d> reference;  //!< true poses
    std::vector<Eigen::Isometry3d> estimate;   //!< the counterparts
    std::vector<double> times_s;               //!< since the first pose
    bool timesAreAssumed = false;     //!< no file has times: ten poses a second, as KITTI has it
    std::vector<bool> predicted;      //!< scans that were not registered; empty where not known
    RelativeError perScan;            //!< of the motion from each pose to the next
    bool framesAreUnknown = false;    //!< the path is too short to see if both are of one frame
    std::string referenceFault;       //!< a warning that true poses are known to be wrong, or empty
    std::string mapPage;              //!< path of a page with the estimate's map; may be empty
    double end_error_m = 0;           //!< between the last poses, relative to the first ones
    std::size_t unusedReference = 0;  //!< reference rows of unused scans
    std::size_t unmatchedReference = 0;  //!< poses of the reference (unused ones apart) and of the
    std::size_t unmatchedEstimate = 0;   //!< estimate without a partner in time

    /** End error divided by the length of the true path; NaN for paths below 0.1 m. */
    double endError_percent() const;
};

/** Settings of compare(). */
struct ComparisonSettings {
    /** Of KITTI's segments. Empty: kittiLengths_m(), or suggestedLengths_m() where the path is
     *  shorter than twice the first of them. */
    std::vector<double> lengths_m;
    std::size_t delta = 1;  //!< poses that `rpe_m` and `rpe_deg` of the row span
};

/** Error: the two trajectories have different moving frames. */
class WrongFrames : public Error {
 public:
    /** With a message that says which, and what to do. */
    explicit WrongFrames(FrameMismatch found);
    FrameMismatch mismatch() const { return mismatch_; }  //!< which way round

 private:
    FrameMismatch mismatch_;
};

/** Matches poses and computes their errors. `scans`: one row per pose of the estimate. If the
 *  reference has no stamps (KITTI), its rows correspond to the scans of the rawlog; rows of scans
 *  that are not in `scans` are ignored, unless there are as many rows as poses. A single pair is
 *  enough. Throws WrongFrames, and Error where no pairs are found, or where the reference has no
 *  row for the last scan. */
Comparison compare(io::Trajectory reference, const io::Trajectory& estimate,
                   const ComparisonSettings& settings, const io::ScanTable* scans = nullptr);
}  // namespace delio::evaluation
