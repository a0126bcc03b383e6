#include "delio/slam/listener.h"

#include <algorithm>
#include <cstdint>

namespace delio {
Eigen::Matrix3Xf stillPoints(const SlamScan& scan) {
    constexpr Eigen::Index kMost = 20000;
    const auto& points = scan.step.used.points;
    const auto& dynamic = scan.step.used.dynamic;
    const auto moving = std::count(dynamic.begin(), dynamic.end(), std::uint8_t{1});
    // At most so many, evenly over their order: of a scan the same share all around.
    const Eigen::Index all = points.cols() - moving,
                       stride = std::max<Eigen::Index>(1, (all + kMost - 1) / kMost);
    Eigen::Matrix3Xf still(3, (all + stride - 1) / stride);
    Eigen::Index kept = 0, toPass = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        if (!dynamic.empty() && dynamic[static_cast<std::size_t>(i)]) continue;
        if (toPass == 0) {
            still.col(kept++) = points.col(i);
            toPass = stride;
        }
        --toPass;
    }
    return scan.scan.sensorPose.cast<float>() * still;
}
}  // namespace delio
