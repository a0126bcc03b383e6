#include "delio/earth/fix.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace delio::earth {
Eigen::Matrix3d covarianceOf(int quality, double hdop) {
    const double base = quality == 2 ? 1.0 : quality == 4 ? 0.02 : quality == 5 ? 0.3 : 3.0;
    const double sigma = base * (hdop > 0 && std::isfinite(hdop) ? std::clamp(hdop, 0.5, 50.0) : 1);
    return Eigen::Vector3d(sigma * sigma, sigma * sigma, 4 * sigma * sigma).asDiagonal();
}

bool isUsable(const Fix& fix) {
    const auto& place = fix.place;
    if (!std::isfinite(fix.stamp_s) || !isPlausible(place)) return false;
    if (place.latitude_deg == 0 && place.longitude_deg == 0) return false;
    return fix.covariance.allFinite() && fix.covariance.llt().info() == Eigen::Success;
}
}  // namespace delio::earth
