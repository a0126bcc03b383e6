#include "delio/slam/loop_closer.h"

#include "delio/scan/sample.h"
#include "delio/scan/spin_axis.h"

namespace delio {
namespace {
/** What stands still, in the vehicle's frame. A submap has many scans: of each a part will do. */
Eigen::Matrix3Xf pointsFor(const SlamScan& scan) {
    constexpr Eigen::Index kMost = 20000;
    const auto& used = scan.step.used;
    Eigen::Matrix3Xf still(3, used.points.cols());
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < used.points.cols(); ++i)
        if (used.dynamic.empty() || !used.dynamic[static_cast<std::size_t>(i)])
            still.col(count++) = used.points.col(i);
    still.conservativeResize(3, count);
    return scan.scan.sensorPose.cast<float>() * scan::sample(still, kMost);
}
}  // namespace

void LoopCloser::add(const SlamScan& scan) {
    const auto& points = scan.step.used.points;
    if (!upIsKnown_ && points.cols() > 0) {
        const Eigen::Isometry3d& sensor = scan.scan.sensorPose;
        up_ = sensor.linear() * scan::uprightOf(sensor, points).row(2).transpose().cast<double>();
        upIsKnown_ = true;
    }
    // Where a scan was taken that could not be registered is a guess.
    builder_.add(scan.node, scan.pose,
                 scan.step.predicted ? Eigen::Matrix3Xf(3, 0) : pointsFor(scan), up_);
}

loops::ClosedLoops LoopCloser::close(const graph::PoseGraph& graph,
                                     const graph::PoseGraphOptions& optimisation) {
    submaps_ = builder_.finish();
    return loops::closeLoops(graph, submaps_, loops_, closures_, optimisation);
}
}  // namespace delio
