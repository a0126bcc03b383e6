#include <cmath>

#include "delio/core/geometry.h"
#include "delio/earth/georeference.h"

namespace delio::earth {
void Georeference::moveOriginToMap() {
    const EnuFrame before(origin);
    origin = before.geodeticOf(enuFromMap.translation());
    enuFromMap = EnuFrame(origin).ecefFromEnu().inverse() * before.ecefFromEnu() * enuFromMap;
    enuFromMap.translation().setZero();
}

double heading_deg(const Eigen::Isometry3d& enuFromMap) {
    const Eigen::Vector3d x = enuFromMap.linear().col(0);
    return std::atan2(x.x(), x.y()) * 180 / M_PI;
}

MapToUtm::MapToUtm(const Georeference& place)
    : enu_(place.origin), enuFromMap_(place.enuFromMap), zone_(utmZoneOf(place.origin)) {
    constexpr double kStep_m = 1000;
    offset_ << (utmOf(place.origin, zone_).head<2>() / kStep_m).array().round() * kStep_m, 0;
    // Where grid north lies clockwise of true north, directions turn the other way.
    const double turn_rad = convergence_deg(place.origin, zone_) * M_PI / 180;
    rotation_ = rotationExp(turn_rad * Eigen::Vector3d::UnitZ()) * enuFromMap_.linear();
}

Eigen::Vector3d MapToUtm::operator()(const Eigen::Vector3d& inMap) const {
    return utmOf(enu_.geodeticOf(enuFromMap_ * inMap), zone_) - offset_;
}
}  // namespace delio::earth
