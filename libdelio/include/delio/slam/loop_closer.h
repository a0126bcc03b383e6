#pragma once
#include "delio/loops/close_loops.h"
#include "delio/slam/listener.h"

namespace delio {
/** Keeps a drive as submaps, and closes its loops when it is over. */
class LoopCloser : public SlamListener {
 public:
    LoopCloser(const loops::SubmapOptions& submaps, const loops::LoopOptions& loops,
               const loops::ClosureOptions& closures)
        : loops_(loops), closures_(closures), builder_(submaps) {}

    const char* name() const override { return "submaps"; }
    void add(const SlamScan& scan) override;
    void undo() noexcept override { builder_.undo(); }

    /** `graph`: of the same drive, a node each scan. Once, after the last scan. */
    loops::ClosedLoops close(const graph::PoseGraph& graph,
                             const graph::PoseGraphOptions& optimisation);

    /** Of the submaps that close() searched. */
    const std::vector<loops::Submap>& submaps() const { return submaps_; }

 private:
    loops::LoopOptions loops_;
    loops::ClosureOptions closures_;
    loops::SubmapBuilder builder_;
    std::vector<loops::Submap> submaps_;
    bool upIsKnown_ = false;
    Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ();  //!< in the vehicle's frame
};
}  // namespace delio
