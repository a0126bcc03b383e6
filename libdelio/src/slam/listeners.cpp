#include "delio/slam/listeners.h"

#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <tbb/parallel_for.h>
#include <algorithm>
#include <optional>
#include <vector>

namespace delio {
void GraphBuilder::add(const SlamScan& scan) {
    const Recent latest{scan.node, scan.step.features, scan.scan.sensorPose};
    if (recent_.empty())
        graph_.addNode(scan.pose);
    else {
        graph_.addNode(graph_.poses().back() * scan.increment.pose);
        graph_.addEdge({latest.node - 1, latest.node, scan.increment});
    }
    if (!scan.corrected.empty()) {
        auto corrected = scan.corrected;
        const Eigen::Isometry3d toGraph = graph_.poses().back() * scan.pose.inverse();
        for (auto& node : corrected) node.pose = toGraph * node.pose;
        graph_.correct(corrected);
    }
    if (!scan.step.predicted && latest.features) {
        const std::size_t before = graph_.edges().size();
        addSkipEdges(latest);
        // The chain alone is what the poses were made of: nothing to optimise.
        if (options_.window > 0 && graph_.edges().size() > before)
            graph_.optimiseLast(options_.window, options_);
    }
    recent_.push_front(latest);
    if (recent_.size() > options_.skip_edges + 1) recent_.pop_back();
}

void GraphBuilder::addSkipEdges(const Recent& latest) {
    const auto& poses = graph_.poses();
    std::vector<std::optional<Link>> links(recent_.size());
    tbb::parallel_for(std::size_t{1}, std::max<std::size_t>(links.size(), 1), [&](std::size_t i) {
        const Recent& earlier = recent_[i];
        if (!earlier.features) return;
        const Eigen::Isometry3d guess = (poses[earlier.node] * earlier.sensorPose).inverse() *
                                        (poses[latest.node] * latest.sensorPose);
        links[i] = latest.features->linkTo(*earlier.features, guess);
    });
    for (std::size_t i = 1; i < recent_.size(); ++i) {
        const auto& link = links[i];
        // Where a scan did not register there is nothing to learn beyond the prediction.
        if (!link) continue;
        if (link->overlap < options_.min_overlap) break;
        graph_.addEdge({recent_[i].node, latest.node,
                        ofVehicle(link->increment, recent_[i].sensorPose, latest.sensorPose)});
    }
}

namespace {
/** The points that were used, with the intensities that the scan came with. */
mrpt::maps::CPointsMap::Ptr pointsForMap(const Scan& scan, const UsedPoints& used) {
    using mrpt::maps::CPointsMapXYZI;
    const auto* from = dynamic_cast<const CPointsMapXYZI*>(scan.points.get());
    const auto bright = from ? CPointsMapXYZI::Create() : nullptr;
    mrpt::maps::CPointsMap::Ptr points = bright;
    if (!points) points = mrpt::maps::CSimplePointsMap::Create();
    points->resize(used.indices.size());
    for (std::size_t i = 0; i < used.indices.size(); ++i) {
        const Eigen::Vector3f p = used.points.col(static_cast<Eigen::Index>(i));
        points->setPointFast(i, p.x(), p.y(), p.z());
        if (bright)  // where MRPT keeps intensities
            bright->setPointColor_fast(i, from->getPointIntensity_fast(used.indices[i]), 0, 0);
    }
    return points;
}
}  // namespace

void MapListener::add(const SlamScan& scan) {
    if (scan.fromOldPose) builder_.keepInPlace(scan.node - 1, *scan.fromOldPose);
    if (scan.step.predicted) return;
    for (const auto& [name, value] : scan.step.details)
        if (name == "scale") builder_.takeScale(value);
    builder_.add(scan.node, scan.pose, *pointsForMap(scan.scan, scan.step.used),
                 scan.scan.sensorPose, scan.scan.time, scan.step.used.dynamic);
}
}  // namespace delio
