#include "places/tiles.h"

namespace delio::places {
Eigen::Matrix3Xf together(const std::vector<Eigen::Matrix3Xf>& parts) {
    Eigen::Index count = 0;
    for (const auto& part : parts) count += part.cols();
    Eigen::Matrix3Xf all(3, count);
    count = 0;
    for (const auto& part : parts) {
        all.middleCols(count, part.cols()) = part;
        count += part.cols();
    }
    return all;
}

Eigen::Matrix3Xf surroundings(std::size_t tile, const std::vector<Eigen::Isometry3d>& level,
                              const std::function<Eigen::Matrix3Xf(std::size_t)>& pointsOf) {
    constexpr float kRadius_m = 60;  // a scan reaches 50 m, and it is taken up to 20 m off
    constexpr double kNear_m = 60 + 0.75 * kTile_m;
    std::vector<Eigen::Matrix3Xf> parts;
    for (std::size_t i = 0; i < level.size(); ++i) {
        const Eigen::Vector3d apart = level[i].translation() - level[tile].translation();
        if (apart.head<2>().norm() > kNear_m) continue;
        const Eigen::Isometry3d there = level[tile].inverse() * level[i];
        Eigen::Matrix3Xf part = there.cast<float>() * pointsOf(i);
        Eigen::Index kept = 0;
        for (Eigen::Index k = 0; k < part.cols(); ++k)
            if (part.col(k).head<2>().norm() <= kRadius_m) part.col(kept++) = part.col(k);
        part.conservativeResize(3, kept);
        parts.push_back(std::move(part));
    }
    return together(parts);
}
}  // namespace delio::places
