#include "vehicle_box.h"

#include "scan_points.h"

namespace delio::io {
std::optional<Scan> WithoutVehicle::next() {
    const auto scan = source_->next();
    if (!scan) return scan;
    Scan rest = partOf(*scan, [&](std::size_t i) {
        Eigen::Vector3f point;
        scan->points->getPointFast(i, point.x(), point.y(), point.z());
        return !box_.contains(scan->sensorPose * point.cast<double>());
    });
    ++scans_;
    inside_ += scan->points->size() - rest.points->size();
    return rest;
}

Recording WithoutVehicle::recording() const {
    Recording recording = source_->recording();
    if (scans_ > 0 && inside_ == 0)
        recording.findings.push_back(
            "no point of any scan lies in the vehicle box: it is given in metres, in the vehicle's "
            "frame");
    return recording;
}
}  // namespace delio::io
