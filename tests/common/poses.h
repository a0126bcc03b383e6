#pragma once
#include <Eigen/Geometry>
#include <vector>

namespace delio::test {
/** Metres and radians; the rotation is Rz(yaw) Ry(pitch) Rx(roll). */
inline Eigen::Isometry3d poseAt(double x, double y, double z, double yaw = 0, double pitch = 0,
                                double roll = 0) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                     Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
                        .toRotationMatrix();
    pose.translation() << x, y, z;
    return pose;
}

/** The same with angles in degrees. */
inline Eigen::Isometry3d poseAtDeg(double x, double y, double z, double yaw, double pitch = 0,
                                   double roll = 0) {
    constexpr double kDeg = M_PI / 180;
    return poseAt(x, y, z, yaw * kDeg, pitch * kDeg, roll * kDeg);
}

inline double metresBetween(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    return (a.translation() - b.translation()).norm();
}

inline double degreesBetween(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
    return Eigen::AngleAxisd(a.transpose() * b).angle() * 180 / M_PI;
}

inline double degreesBetween(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    return degreesBetween(Eigen::Matrix3d(a.linear()), Eigen::Matrix3d(b.linear()));
}

/** Rotation about z of a pose, radians. */
inline double yawOf(const Eigen::Isometry3d& pose) { return std::atan2(pose(1, 0), pose(0, 0)); }

/** Each as seen from the first. */
inline std::vector<Eigen::Isometry3d> fromFirst(const std::vector<Eigen::Isometry3d>& poses) {
    std::vector<Eigen::Isometry3d> result;
    result.reserve(poses.size());
    for (const auto& pose : poses) result.push_back(poses.front().inverse() * pose);
    return result;
}
}  // namespace delio::test
