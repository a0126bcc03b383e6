#include "odometry/place_scale.h"

#include "delio/odometry/odometry.h"

namespace delio::odometry {
PlaceScale::PlaceScale(const PlaneOdometryOptions& options)
    : given_(options), options_(atScale(options, 1)) {}

void PlaceScale::see(const Scan& scan) {
    seen_ = given_.tracker.scale > 0 ? given_.tracker.scale : scaleOf(scan);
}

bool PlaceScale::isOther() {
    constexpr double kOther = 2;
    constexpr unsigned kPatience = 10;
    const double ratio = seen_ / scale_;
    others_ = ratio >= kOther || ratio <= 1 / kOther ? others_ + 1 : 0;
    return others_ >= kPatience;
}

void PlaceScale::use(double scale) {
    scale_ = scale;
    others_ = 0;
    options_ = atScale(given_, scale);
}
}  // namespace delio::odometry
