#include "slam/place_listeners.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <chrono>
#include <utility>

#include "core/spread_threads.h"
#include "delio/core/error.h"
#include "delio/core/stopwatch.h"
#include "odometry/spin_axis.h"

namespace delio {
LoopCloser::LoopCloser(const places::SubmapOptions& submaps, const places::LoopOptions& loops,
                       const places::ClosureOptions& closures, const std::string& folder)
    : builder_(submaps), search_(loops, closures, folder) {}

void LoopCloser::add(const SlamScan& scan) {
    const auto& points = scan.step.used.points;
    if (!upIsKnown_ && points.cols() > 0) {
        up_ = odometry::upIn(scan.scan.sensorPose, points);
        upIsKnown_ = true;
    }
    // The pose of an unregistered scan is only predicted: its points are left out.
    const auto still = scan.step.predicted ? Eigen::Matrix3Xf(3, 0) : staticPoints(scan);
    end(builder_.add(scan.node, scan.increment, still, up_));
    poses_.push_back(scan.pose);
    searchNext();
}

void LoopCloser::end(std::future<places::Submap> submap) {
    if (submap.valid()) waiting_.push_back({std::move(submap), std::exchange(poses_, {})});
}

/** Searches for all submaps that wait, unless the thread is busy: in a thread of its own, or here
 *  if there is only one, or if the system has no more threads. */
void LoopCloser::searchNext() noexcept {
    const bool isBusy =
        busy_.valid() && busy_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
    if (waiting_.empty() || isBusy) return;
    taken_ = std::exchange(waiting_, {});
    using Control = tbb::global_control;
    if (Control::active_value(Control::max_allowed_parallelism) > 1) try {
            busy_ = std::async(std::launch::async, [this] {
                runAnywhere();
                searchTaken();
            });
            return;
        } catch (const std::exception&) {
            // The system has no more threads.
        }
    searchTaken();
}

/** By one thread: the others are the odometry's. */
void LoopCloser::searchTaken() noexcept {
    Stopwatch watch;
    try {
        tbb::task_arena(1).execute([&] {
            for (auto& [ended, poses] : taken_) {
                if (fault_) break;
                places::Submap submap = ended.get();
                const Eigen::Isometry3d& pose = poses[submap.key - submap.first];
                search_.add(std::move(submap), pose);
            }
        });
    } catch (...) {
        fault_ = std::current_exception();
    }
    taken_.clear();
    search_ms_ += watch.lap_ms();
}

places::ClosedLoops LoopCloser::close(const graph::PoseGraph& graph,
                                      const graph::PoseGraphOptions& optimisation) {
    if (busy_.valid()) busy_.wait();
    end(builder_.finish());
    taken_ = std::exchange(waiting_, {});
    searchTaken();
    if (fault_) std::rethrow_exception(fault_);
    return places::closeLoops(graph, search_, optimisation);
}

void MapFollower::add(const SlamScan& scan) {
    const auto& points = scan.step.used.points;
    if (!up_ && points.cols() > 0) up_ = odometry::upIn(scan.scan.sensorPose, points);
    if (history_ == History::Last) fixes_.clear();
    fixes_.push_back(
        tracker_.add(scan.increment, staticPoints(scan), up_.value_or(Eigen::Vector3d::UnitZ())));
}
}  // namespace delio
