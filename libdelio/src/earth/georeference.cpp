#include <Eigen/Dense>
#include <cmath>

#include "delio/core/error.h"
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

namespace {
constexpr std::size_t kFewestPoints = 3;

/** Of the points, which were placed with the pose's rotation and translation unknown. */
Matrix6 covarianceOf(const Eigen::Matrix3Xd& inMap, double squaredErrors) {
    Matrix6 information = Matrix6::Zero();
    for (Eigen::Index i = 0; i < inMap.cols(); ++i) {
        Eigen::Matrix<double, 3, 6> J;
        J << Eigen::Matrix3d::Identity(), -hat(inMap.col(i));
        information += J.transpose() * J;
    }
    const double redundancy = 3.0 * static_cast<double>(inMap.cols()) - 6;
    return squaredErrors / redundancy * information.inverse();
}
}  // namespace

Georeference georeferenceOf(const std::vector<ControlPoint>& points) {
    constexpr double kOnOneLine = 0.02, kContradiction = 0.25;  // of the extent
    std::vector<const ControlPoint*> used;
    for (const auto& point : points)
        if (point.isUsed) used.push_back(&point);
    if (used.size() < kFewestPoints)
        throw Error("control points: at least three have to be used; there are " +
                    std::to_string(used.size()));
    Georeference place;
    place.origin = used.front()->place;
    const EnuFrame enu(place.origin);
    const auto count = static_cast<Eigen::Index>(used.size());
    Eigen::Matrix3Xd inMap(3, count), inEnu(3, count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const ControlPoint& point = *used[static_cast<std::size_t>(i)];
        inMap.col(i) = point.inMap;
        inEnu.col(i) = enu.enuOf(point.place);
    }
    const Eigen::Matrix3Xd spread = inMap.colwise() - inMap.rowwise().mean();
    const Eigen::Vector3d extents = Eigen::JacobiSVD<Eigen::MatrixXd>(spread).singularValues();
    if (!(extents[1] > kOnOneLine * extents[0]))
        throw Error("control points: the used ones lie on one line");
    place.enuFromMap.matrix() = Eigen::umeyama(inMap, inEnu, false);
    const double squared = (place.enuFromMap * inMap - inEnu).squaredNorm();
    if (std::sqrt(squared) > kContradiction * extents[0])
        throw Error(
            "control points: the map does not fit them: their distances differ from those "
            "in the map");
    place.covariance = covarianceOf(inMap, squared);
    place.moveOriginToMap();
    return place;
}

Eigen::Vector3d errorOf(const ControlPoint& point, const Georeference& place) {
    const EnuFrame there(point.place);
    return there.enuOf(place.geodeticOf(point.inMap));
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
