#include "initial_pose.h"

#include <cmath>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/core/geometry.h"

namespace delio {
Eigen::Isometry3d initialPoseIn(const std::string& text) {
    const auto numbers = cli::numbersIn(text, 4);
    if (numbers.empty())
        throw Error(
            "--initial-pose needs X,Y,Z,YAW_DEG (metres and degrees in the map's frame), not '" +
            text + "'");
    return isometry(rotationExp({0, 0, numbers[3] * M_PI / 180}),
                    {numbers[0], numbers[1], numbers[2]});
}

Eigen::Vector3d antennaIn(const std::string& text) {
    const auto numbers = cli::numbersIn(text, 3);
    if (numbers.empty() || Eigen::Vector3d(numbers.data()).norm() > 100)
        throw Error("--antenna needs X,Y,Z (metres in the vehicle frame), not '" + text + "'");
    return Eigen::Vector3d(numbers.data());
}
}  // namespace delio
