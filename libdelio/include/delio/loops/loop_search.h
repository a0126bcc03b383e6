#pragma once
#include <string>
#include <vector>

#include "delio/graph/pose_graph.h"
#include "delio/loops/closure.h"
#include "delio/loops/submap.h"

namespace delio::loops {
struct LoopOptions : public StageOptions {
    double min_path = 50;
    double drift = 0.005;
    double drift_up = 0.01;
    double drift_deg = 0.5;
    double rival = 0.8;
    double reach = 30;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Two submaps that may show one place, and what was found. */
struct LoopCandidate {
    std::size_t from = 0, to = 0;          //!< submaps, the earlier first
    std::size_t fromNode = 0, toNode = 0;  //!< their key nodes
    double path_m = 0;                     //!< driven between
    double reach_m = 0;  //!< within which it was looked for, about where the poses say
    double share = 0;    //!< of the height images that met
    double moved_m = 0;  //!< found so far from where the poses say
    Closure closure;     //!< with the reason why it was not accepted
    bool accepted() const { return closure.reason.empty(); }
};

/** Looks for places that a drive came back to: of all pairs of submaps that may lie one over the
 *  other, as far as the drive may have drifted, rotation first (azimuths, free of the translation),
 *  then the shift (height images), then by registration both ways. `poses`: of the graph's nodes,
 * as well as they are known. `known`: of an earlier search, when they were known worse; what was
 * accepted is taken over. In the order of `to`, then `from`; the same bytes for any number of
 * threads. */
std::vector<LoopCandidate> searchLoops(const std::vector<Submap>& submaps,
                                       const std::vector<Eigen::Isometry3d>& poses,
                                       const LoopOptions& options, const ClosureOptions& closure,
                                       const std::vector<LoopCandidate>& known = {});
}  // namespace delio::loops
