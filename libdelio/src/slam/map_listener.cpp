#include "delio/slam/map_listener.h"

#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>

namespace delio {
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
    if (scan.step.predicted) return;
    for (const auto& [name, value] : scan.step.details)
        if (name == "scale") builder_.takeScale(value);
    builder_.add(scan.node, scan.pose, *pointsForMap(scan.scan, scan.step.used),
                 scan.scan.sensorPose, scan.scan.time, scan.step.used.dynamic);
}
}  // namespace delio
