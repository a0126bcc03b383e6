#include "delio/map/edit.h"

#include <algorithm>

#include "voxel_set.h"

namespace delio::map {
namespace {
template <typename IsOut>
void removeIf(MapPoints& points, const IsOut& isOut) {
    points.erase(std::remove_if(points.begin(), points.end(), isOut), points.end());
}
}  // namespace

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

void thinOut(MapPoints& points, double spacing) {
    VoxelSet taken(spacing);
    removeIf(points,
             [&](const MapPoint& point) { return !taken.insert(point.position.cast<double>()); });
}
}  // namespace delio::map
