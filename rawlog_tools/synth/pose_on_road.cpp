#include "pose_on_road.h"

namespace delio::synth {
Eigen::Isometry3d poseOnRoad(const Road& road, double s, double side_m,
                             const Footprint& footprint) {
    const auto wheel = [&](double along, double across) {
        const double side = side_m + across;
        const Eigen::Vector2d place = road.point(s + along, side);
        return Eigen::Vector3d(place.x(), place.y(), road.height(place));
    };
    const Eigen::Vector3d fl = wheel(footprint.along_m, footprint.across_m);
    const Eigen::Vector3d fr = wheel(footprint.along_m, -footprint.across_m);
    const Eigen::Vector3d rl = wheel(-footprint.along_m, footprint.across_m);
    const Eigen::Vector3d rr = wheel(-footprint.along_m, -footprint.across_m);
    const Eigen::Vector3d forward = (fl + fr - rl - rr).normalized();
    const Eigen::Vector3d up = forward.cross(fl + rl - fr - rr).normalized();

    const Eigen::Vector2d middle = road.point(s, side_m);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear().col(0) = forward;
    pose.linear().col(1) = up.cross(forward);
    pose.linear().col(2) = up;
    pose.translation() << middle, (fl + fr + rl + rr).z() / 4;
    return pose;
}
}  // namespace delio::synth
