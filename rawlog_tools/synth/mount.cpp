#include "mount.h"

#include <cmath>
#include <sstream>
#include <vector>

#include "delio/core/text.h"

namespace delio::synth {
namespace {
constexpr double kDegree = 3.14159265358979323846 / 180;
}  // namespace

Eigen::Isometry3d Mount::pose() const {
    using Eigen::AngleAxisd;
    using Eigen::Vector3d;
    return Eigen::Isometry3d(AngleAxisd(yaw_deg * kDegree, Vector3d::UnitZ()) *
                             AngleAxisd(pitch_deg * kDegree, Vector3d::UnitY()) *
                             AngleAxisd(roll_deg * kDegree, Vector3d::UnitX()));
}

void Mount::turn(ScanPoints& points) const {
    if (isUpright()) return;
    const Eigen::Matrix3d turned = pose().linear().transpose();
    for (std::size_t i = 0; i < points.size(); ++i) {
        Eigen::Map<Eigen::Vector3f> point(&points.xyzi[4 * i]);
        point = (turned * point.cast<double>()).cast<float>();
    }
}

std::optional<Mount> mountIn(const std::string& text) {
    std::vector<double> angles;
    std::istringstream words(text + ",");
    for (std::string word; std::getline(words, word, ',');) {
        const auto angle = numberIn<double>(word);
        if (!angle || !std::isfinite(*angle)) return {};
        angles.push_back(*angle);
    }
    if (angles.size() != 3) return {};
    return Mount{angles[0], angles[1], angles[2]};
}
}  // namespace delio::synth
