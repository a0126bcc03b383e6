#pragma once
#include <Eigen/Geometry>

#include <cstddef>
#include <string>
#include <vector>

#include "delio/core/error.h"
#include "delio/evaluation/frame_check.h"
#include "delio/evaluation/relative_error.h"
#include "delio/evaluation/score.h"
#include "delio/formats/scan_table.h"
#include "delio/formats/trajectory.h"

namespace delio::evaluation {
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
