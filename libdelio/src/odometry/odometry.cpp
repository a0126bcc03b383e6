#include "delio/odometry/odometry.h"

#include "delio/core/error.h"

namespace delio {
void Odometry::save(std::ostream& /*out*/) const {
    throw Error("the state of this odometry cannot be kept");
}

void Odometry::restore(std::istream& /*in*/) {
    throw Error("the state of this odometry cannot be kept");
}
}  // namespace delio
