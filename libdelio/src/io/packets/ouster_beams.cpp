#include "ouster_beams.h"

#include <cmath>

#include "core/portable_math.h"

namespace delio::io {
OusterBeams::OusterBeams(const OusterInfo& info)
    : rows_(info.rows),
      beamOrigin_m_(static_cast<float>(std::hypot(info.beamOut_m, info.beamUp_m))) {
    const Eigen::Matrix3d rotation = info.lidarToSensor.topLeftCorner<3, 3>();
    const Eigen::Vector3d translation = info.lidarToSensor.topRightCorner<3, 1>();
    for (std::size_t column = 0; column < info.columns; ++column) {
        // It turns clockwise, angles count counter-clockwise.
        const double turned =
            2 * M_PI * (1 - static_cast<double>(column) / static_cast<double>(info.columns));
        const Eigen::Vector3d origin(info.beamOut_m * portable::cos(turned),
                                     info.beamOut_m * portable::sin(turned), info.beamUp_m);
        origins_.emplace_back((rotation * origin + translation).cast<float>());
        for (std::size_t row = 0; row < info.rows; ++row) {
            const double angle = turned - info.azimuths[row], up = info.elevations[row];
            const Eigen::Vector3d direction(portable::cos(angle) * portable::cos(up),
                                            portable::sin(angle) * portable::cos(up),
                                            portable::sin(up));
            directions_.emplace_back((rotation * direction).cast<float>());
        }
    }
}
}  // namespace delio::io
