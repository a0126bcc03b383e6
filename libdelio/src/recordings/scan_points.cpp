#include "scan_points.h"

#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>

namespace delio::io {
using mrpt::maps::CPointsMapXYZI;

mrpt::maps::CPointsMap::Ptr emptyLike(const mrpt::maps::CPointsMap& points) {
    if (dynamic_cast<const CPointsMapXYZI*>(&points)) return CPointsMapXYZI::Create();
    return mrpt::maps::CSimplePointsMap::Create();
}

void addPoint(const mrpt::maps::CPointsMap& from, std::size_t i, const Eigen::Isometry3d& pose,
              mrpt::maps::CPointsMap& to) {
    Eigen::Vector3f point;
    from.getPointFast(i, point.x(), point.y(), point.z());
    point = (pose * point.cast<double>()).cast<float>();
    to.insertPointFast(point.x(), point.y(), point.z());
    auto* bright = dynamic_cast<CPointsMapXYZI*>(&to);
    if (!bright) return;
    const auto* source = dynamic_cast<const CPointsMapXYZI*>(&from);
    bright->setPointIntensity(to.size() - 1, source ? source->getPointIntensity(i) : 0.0F);
}

Scan partOf(const Scan& scan, const std::function<bool(std::size_t)>& isWanted) {
    Scan part = scan;
    part.points = emptyLike(*scan.points);
    part.rings.clear();
    part.times_s.clear();
    for (std::size_t i = 0; i < scan.points->size(); ++i) {
        if (!isWanted(i)) continue;
        addPoint(*scan.points, i, Eigen::Isometry3d::Identity(), *part.points);
        if (!scan.rings.empty()) part.rings.push_back(scan.rings[i]);
        if (!scan.times_s.empty()) part.times_s.push_back(scan.times_s[i]);
    }
    return part;
}
}  // namespace delio::io
