#include "delio/slam/listener.h"

#include "delio/scan/sample.h"

namespace delio {
Eigen::Matrix3Xf stillPoints(const SlamScan& scan) {
    constexpr Eigen::Index kMost = 20000;
    const auto& used = scan.step.used;
    Eigen::Matrix3Xf still(3, used.points.cols());
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < used.points.cols(); ++i)
        if (used.dynamic.empty() || !used.dynamic[static_cast<std::size_t>(i)])
            still.col(count++) = used.points.col(i);
    still.conservativeResize(3, count);
    return scan.scan.sensorPose.cast<float>() * scan::sample(still, kMost);
}
}  // namespace delio
