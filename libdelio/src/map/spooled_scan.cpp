#include "spooled_scan.h"

#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>

namespace delio::map {
void SpooledScan::load() const {
    if (pointcloud) return;
    const auto floats = spool_->read(place_);
    const auto withIntensity = withIntensity_ ? mrpt::maps::CPointsMapXYZI::Create() : nullptr;
    mrpt::maps::CPointsMap::Ptr cloud = withIntensity;
    if (!cloud) cloud = mrpt::maps::CSimplePointsMap::Create();
    cloud->reserve(floats.size() / 4);
    for (std::size_t i = 0; 4 * i < floats.size(); ++i) {
        const float* p = &floats[4 * i];
        if (votes_->isDynamic(sensorInWorld_ * Eigen::Vector3f(p[0], p[1], p[2]).cast<double>()))
            continue;
        if (withIntensity)
            withIntensity->insertPointRGB(p[0], p[1], p[2], p[3], 0, 0);
        else
            cloud->insertPointFast(p[0], p[1], p[2]);
    }
    cloud->mark_as_modified();
    // MRPT's own load() of scans that are stored elsewhere does the same to a const object.
    const_cast<SpooledScan*>(this)->pointcloud = cloud;
}

void SpooledScan::unload() const { const_cast<SpooledScan*>(this)->pointcloud.reset(); }

void SpooledScan::serializeTo(mrpt::serialization::CArchive& out) const {
    const bool wasLoaded = pointcloud != nullptr;
    load();
    CObservationPointCloud::serializeTo(out);
    if (!wasLoaded) unload();
}
}  // namespace delio::map
