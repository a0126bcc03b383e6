#include "delio/map/map_point.h"

namespace delio::map {
using mrpt::maps::CPointsMap;
using mrpt::maps::CPointsMapXYZI;

CPointsMapXYZI cloudOf(const MapPoints& points) {
    CPointsMapXYZI cloud;
    cloud.reserve(points.size());
    for (const auto& point : points)
        cloud.insertPointRGB(point.position.x(), point.position.y(), point.position.z(),
                             point.intensity, 0, 0);
    return cloud;
}

MapPoints pointsOf(const CPointsMap& cloud) {
    const auto& x = cloud.getPointsBufferRef_x();
    const auto& y = cloud.getPointsBufferRef_y();
    const auto& z = cloud.getPointsBufferRef_z();
    const auto* withIntensity = dynamic_cast<const CPointsMapXYZI*>(&cloud);
    MapPoints points(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        points[i].position = {x[i], y[i], z[i]};
        if (withIntensity) points[i].intensity = withIntensity->getPointIntensity_fast(i);
    }
    return points;
}
}  // namespace delio::map
