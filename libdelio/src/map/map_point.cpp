#include "delio/map/map_point.h"

#include <algorithm>

#include "map/ground.h"
#include "map/voxel_set.h"

namespace delio::map {
using mrpt::maps::CPointsMap;
using mrpt::maps::CPointsMapXYZI;

namespace {
template <typename IsOut>
void removeIf(MapPoints& points, const IsOut& isOut) {
    points.erase(std::remove_if(points.begin(), points.end(), isOut), points.end());
}
}  // namespace

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

void move(MapPoints& points, const Eigen::Isometry3d& otherFromMap) {
    for (auto& point : points) {
        point.position = (otherFromMap * point.position.cast<double>()).cast<float>();
        point.normal = (otherFromMap.linear() * point.normal.cast<double>()).cast<float>();
    }
}

void crop(MapPoints& points, const Eigen::AlignedBox3d& box) {
    removeIf(points, [&](const MapPoint& point) {
        return !box.contains(Eigen::Vector3d(point.position.cast<double>()));
    });
}

void cutAbove(MapPoints& points, MapPoints& dynamic, double height) {
    const GroundHeight ground(points.size(), [&](std::size_t i) { return points[i].position; });
    for (auto* each : {&points, &dynamic})
        removeIf(*each,
                 [&](const MapPoint& point) { return ground.above(point.position) > height; });
}

void thinOut(MapPoints& points, double spacing) {
    VoxelSet taken(spacing);
    removeIf(points,
             [&](const MapPoint& point) { return !taken.insert(point.position.cast<double>()); });
}
}  // namespace delio::map
