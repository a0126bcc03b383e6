#pragma once
#include <memory>
#include <string>
#include <vector>

#include "delio/loops/closure.h"
#include "delio/loops/sketch.h"
#include "delio/loops/submap.h"

namespace delio::loops {
class Places;

/** Where loops are looked for, and which are believed. */
struct LoopOptions : public StageOptions {
    double min_path = 50;
    double drift = 0.005;
    double drift_up = 0.01;
    double drift_deg = 0.5;
    double rival = 0.8;
    double repeats = 0.55;
    double reach = 30;

 protected:
    std::vector<OptionField> fields() const override;
};

/** By how much an odometry may be off after a stretch: standard deviations along a level axis, of
 *  the height and of the rotation. */
struct Drift {
    double level_m = 0;   //!< along x or y, metres
    double up_m = 0;      //!< along z, metres
    double turn_rad = 0;  //!< about any axis
};
/** What the options expect of so much path, and what the odometry's own covariances say, summed. */
Drift driftOf(const Stretch& driven, const LoopOptions& options);

/** Two submaps that may show one place, and what was found. */
struct LoopCandidate {
    std::size_t from = 0;      //!< the earlier submap
    std::size_t to = 0;        //!< the later one
    std::size_t fromNode = 0;  //!< key node of `from`
    std::size_t toNode = 0;    //!< key node of `to`
    double path_m = 0;         //!< driven between
    double reach_m = 0;        //!< within which it was looked for, about `expected`
    Eigen::Isometry3d expected = Eigen::Isometry3d::Identity();  //!< `to` to `from`, level frames
    double share = 0;                                            //!< of the height images that met
    Closure closure;  //!< with the reason why it was not accepted
    bool accepted() const { return closure.reason.empty(); }  //!< both are one place
    double moved_m() const;  //!< found so far from where it was expected
};

/** Looks for places that a drive came back to: of all pairs of submaps that may lie one over the
 *  other, as far as the drive may have drifted, rotation first (azimuths, free of the translation),
 *  then the shift (height images), then by registration both ways. The points of the submaps lie on
 *  the disk meanwhile. */
class LoopSearch {
 public:
    /** `folder`: where submaps are put aside, in a file without a name; empty: the system's for
     *  temporary files. */
    LoopSearch(const LoopOptions& options, const ClosureOptions& closure, std::string folder = "");
    ~LoopSearch();

    /** The drive's next submap, compared with all before it; pose: of its key node's vehicle.
     *  Error where it cannot be put aside. */
    void add(Submap submap, const Eigen::Isometry3d& keyPose);

    /** Once more, with other poses of the graph's nodes, which are known better now: what was
     *  found stays, and so does what is expected where it was looked for. */
    void again(const std::vector<Eigen::Isometry3d>& poses);

    /** In the order of `to`, then `from`. */
    const std::vector<LoopCandidate>& candidates() const { return candidates_; }
    /** Without their points. */
    const std::vector<Submap>& submaps() const { return submaps_; }
    /** What a submap is found by. */
    const Sketch& sketch(std::size_t submap) const;
    /** Of a submap; from the disk. */
    Eigen::Matrix3Xf points(std::size_t submap) const;
    const LoopOptions& options() const { return options_; }  //!< that it was made with

 private:
    void compare(std::size_t from, std::size_t to, const std::vector<LoopCandidate>& known);
    void search(LoopCandidate& pair);
    double bareShare(const LoopCandidate& pair) const;
    bool repeats(std::size_t submap, double reach_m);

    LoopOptions options_;
    ClosureOptions closure_;
    std::vector<Submap> submaps_;
    std::vector<Eigen::Isometry3d> level_;  //!< their level frames
    std::vector<LoopCandidate> candidates_;
    std::unique_ptr<Places> places_;
};
}  // namespace delio::loops
