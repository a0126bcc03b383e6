#pragma once
#include <memory>
#include <string>
#include <vector>

#include "delio/places/loops.h"
#include "delio/places/submap.h"
#include "places/descriptor.h"

namespace delio::places {
class SubmapStore;

/** Height drift as a fraction of the path (standard deviation): twice LoopOptions::drift, as in the
 *  drives of share/doc/method/loops.md. */
constexpr double kDriftUp = 0.01;
/** Rotation drift after 100 m of path, degrees (standard deviation about any axis); it grows with
 *  the square root of the path. */
constexpr double kDrift_deg = 0.5;

/** Expected drift of an odometry along a path segment, as standard deviations. */
struct Drift {
    double level_m = 0;   //!< along x or y, metres
    double up_m = 0;      //!< along z, metres
    double turn_rad = 0;  //!< about any axis
};
/** Sum of the drift that the options expect and of the odometry's own standard deviations. */
Drift driftOf(const PathSegment& driven, const LoopOptions& options);

/** Likely shifts of one submap's descriptor onto another's within `reach_m` and `turn_rad` of
 *  `guess`: rotations first, then the shift under each; the best shifts, of whatever rotation, the
 *  best first. Those with less than `rival` of the best overlap are left out. */
std::vector<Shift> shiftsOf(const Descriptor& from, const Descriptor& to,
                            const Eigen::Isometry3d& guess, double reach_m, double turn_rad,
                            double rival);

/** Searches for loops. Candidates are all pairs of submaps that may overlap, given the expected
 * drift. For each, the rotation is found first (wall orientations, which no translation changes),
 * then the shift (height images), and the result is verified by registration in both directions.
 * Points of submaps lie in a temporary file. */
class LoopSearch {
 public:
    /** `folder`: of the temporary file; empty: the system's. */
    LoopSearch(const LoopOptions& options, const ClosureOptions& closure, std::string folder = "");
    ~LoopSearch();
    LoopSearch(const LoopSearch&) = delete;
    LoopSearch& operator=(const LoopSearch&) = delete;

    /** Adds the drive's next submap and compares it with all before. `keyPose`: of the vehicle at
     *  its key node. Error if the temporary file cannot be written. */
    void add(Submap submap, const Eigen::Isometry3d& keyPose);

    /** Searches again with better poses of the graph's nodes. Accepted candidates stay, and so do
     *  those whose expected pose stays. */
    void again(const std::vector<Eigen::Isometry3d>& poses);

    /** In the order of `to`, then `from`. */
    const std::vector<LoopCandidate>& candidates() const { return candidates_; }
    /** Without their points. */
    const std::vector<Submap>& submaps() const { return submaps_; }
    /** Of a submap. */
    const Descriptor& descriptor(std::size_t submap) const;
    /** Points of a submap, read from the temporary file. */
    Eigen::Matrix3Xf points(std::size_t submap) const;
    const LoopOptions& options() const { return options_; }  //!< that it was made with

 private:
    void compare(std::size_t from, std::size_t to, const std::vector<LoopCandidate>& known);
    void search(LoopCandidate& pair);
    double freeSpaceConflict(const LoopCandidate& pair) const;
    bool repeats(std::size_t submap, double reach_m);

    LoopOptions options_;
    ClosureOptions closure_;
    std::vector<Submap> submaps_;
    std::vector<Eigen::Isometry3d> level_;  //!< their level frames
    std::vector<LoopCandidate> candidates_;
    std::unique_ptr<SubmapStore> store_;
};
}  // namespace delio::places
