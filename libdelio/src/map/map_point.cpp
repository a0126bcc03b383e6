#include "delio/map/map_point.h"

namespace delio::map {
using mrpt::maps::CPointsMap;
using mrpt::maps::CPointsMapXYZI;

CPointsMapXYZI cloudOf(const MapPoints& points) {
    CPointsMapXYZI cloud;
    cloud.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3f& p = points[i].position;
        cloud.setPointFast(i, p.x(), p.y(), p.z());
        cloud.setPointColor_fast(i, points[i].intensity, 0, 0);  // where MRPT keeps intensities
    }
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
