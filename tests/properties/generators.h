#pragma once
#include <rapidcheck.h>

#include <Eigen/Geometry>

#include <cstdint>
#include <vector>

#include "delio/core/geometry.h"

/** What properties hold for: each draw is another one, and shrinks to the simplest that fails. */
namespace delio::test {
/** Of [-most, most], even a third of a thousandth of it. */
inline double drawReal(double most) {
    constexpr int kSteps = 3000;
    return most * *rc::gen::inRange(-kSteps, kSteps + 1) / kSteps;
}

inline Eigen::Vector3d drawVector(double most) {
    const double x = drawReal(most), y = drawReal(most), z = drawReal(most);
    return {x, y, z};
}

/** Translation within a cube of `metres` to each side, rotation by up to `degrees` about each axis
 *  in turn (180: any rotation). */
inline Eigen::Isometry3d drawPose(double metres, double degrees) {
    using Eigen::AngleAxisd;
    using Eigen::Vector3d;
    const Vector3d angles = drawVector(degrees * M_PI / 180);
    const auto R = AngleAxisd(angles.z(), Vector3d::UnitZ()) *
                   AngleAxisd(angles.y(), Vector3d::UnitY()) *
                   AngleAxisd(angles.x(), Vector3d::UnitX());
    return isometry(R.toRotationMatrix(), drawVector(metres));
}

/** A drive of `count` poses from the origin, each step within `metres` and `degrees`. */
inline std::vector<Eigen::Isometry3d> drawDrive(int count, double metres, double degrees) {
    std::vector<Eigen::Isometry3d> poses = {Eigen::Isometry3d::Identity()};
    while (static_cast<int>(poses.size()) < count)
        poses.push_back(normalised(poses.back() * drawPose(metres, degrees)));
    return poses;
}

/** Largest difference of an entry of the matrices. */
inline double difference(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}
}  // namespace delio::test
