#include "delio/slam/loop_closer.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <chrono>

#include "../core/checkpoint.h"
#include "delio/core/error.h"
#include "delio/core/stopwatch.h"
#include "delio/scan/spin_axis.h"

namespace delio {
LoopCloser::LoopCloser(const loops::SubmapOptions& submaps, const loops::LoopOptions& loops,
                       const loops::ClosureOptions& closures, const std::string& folder,
                       bool isKept)
    : builder_(submaps), search_(loops, closures, folder, isKept) {}

void LoopCloser::add(const SlamScan& scan) {
    const auto& points = scan.step.used.points;
    if (!upIsKnown_ && points.cols() > 0) {
        up_ = scan::upIn(scan.scan.sensorPose, points);
        upIsKnown_ = true;
    }
    // Where a scan was taken that could not be registered is a guess.
    auto ended =
        builder_.add(scan.node, scan.increment,
                     scan.step.predicted ? Eigen::Matrix3Xf(3, 0) : stillPoints(scan), up_);
    end(std::move(ended));
    poses_.push_back(scan.pose);
    searchNext();
}

void LoopCloser::undo() noexcept {
    builder_.undo();
    poses_.pop_back();
}

std::string LoopCloser::faultText() const {
    if (!fault_) return {};
    try {
        std::rethrow_exception(fault_);
    } catch (const std::exception& e) {
        return plainMessage(e);
    }
}

void LoopCloser::takeFault(const std::string& text) {
    fault_ = text.empty() ? nullptr : std::make_exception_ptr(Error(text));
}

/** What the thread is busy with is waited for. */
void LoopCloser::save(std::ostream& out) const {
    if (busy_.valid()) busy_.wait();
    checkpoint::save(out, {"submaps", checkpoint::textOf({&builder_.options()})}, *this);
    search_.save(out);
}

void LoopCloser::restore(std::istream& in) {
    checkpoint::restore(in, {"submaps", checkpoint::textOf({&builder_.options()})}, *this);
    search_.restore(in);
}

void LoopCloser::end(std::optional<loops::Submap> submap) {
    if (!submap) return;
    const Eigen::Isometry3d pose = poses_[submap->key];
    waiting_.push_back({std::move(*submap), pose});
}

/** Whatever waits, unless the thread is busy. */
void LoopCloser::searchNext() {
    const bool isBusy =
        busy_.valid() && busy_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
    if (waiting_.empty() || isBusy) return;
    using Control = tbb::global_control;
    if (Control::active_value(Control::max_allowed_parallelism) > 1)
        busy_ = std::async(std::launch::async, [this, submaps = std::move(waiting_)]() mutable {
            search(std::move(submaps));
        });
    else
        search(std::move(waiting_));
    waiting_.clear();
}

/** By one thread: the others are the odometry's. */
void LoopCloser::search(std::vector<Ended> submaps) {
    Stopwatch watch;
    tbb::task_arena(1).execute([&] {
        try {
            for (auto& [submap, pose] : submaps)
                if (!fault_) search_.add(std::move(submap), pose);
        } catch (...) {
            fault_ = std::current_exception();
        }
    });
    search_ms_ += watch.lap_ms();
}

loops::ClosedLoops LoopCloser::close(const graph::PoseGraph& graph,
                                     const graph::PoseGraphOptions& optimisation) {
    if (busy_.valid()) busy_.wait();
    end(builder_.finish());
    search(std::move(waiting_));
    if (fault_) std::rethrow_exception(fault_);
    return loops::closeLoops(graph, search_, optimisation);
}
}  // namespace delio
