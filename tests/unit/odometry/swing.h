#pragma once
#include <cmath>
#include <functional>

#include "delio/core/geometry.h"
#include "odometry/register_trajectory.h"
#include "poses.h"
#include "ring_scan.h"

namespace delio::test {
/** Pose at a time of a sensor that a hand swings: 8 deg and 5 cm about and along all axes, 1.5
 * times a second. */
inline Eigen::Isometry3d swung(double time_s) {
    const double phase = 2 * M_PI * 1.5 * time_s;
    const Eigen::Vector3d sines(std::sin(phase), std::sin(phase + 1), std::sin(phase + 2));
    return isometry(rotationExp(8 * M_PI / 180 * sines),
                    Eigen::Vector3d(1.2 * time_s, 0, 0) + 0.05 * sines);
}

/** A turn of 0.1 s of a sensor that moves so, about `middle_s`; times from there. */
inline odometry::TimedPoints sweep(const Scene& scene, double noise_m, double middle_s = 0,
                                   const std::function<Eigen::Isometry3d(double)>& pose = swung) {
    constexpr int kColumns = 200;
    Noise noise(3);
    odometry::TimedPoints scan{Eigen::Matrix3Xd(3, 0), {}};
    for (int c = 0; c < kColumns; ++c) {
        const double time_s = 0.1 * c / kColumns - 0.05, azimuth = 2 * M_PI * c / kColumns;
        const Eigen::Isometry3d head(Eigen::AngleAxisd(azimuth, Eigen::Vector3d::UnitZ()));
        const auto points =
            ringScan(scene, pose(middle_s + time_s) * head, {32, 1, -24, 8, noise_m}, noise).points;
        const Eigen::Index before = scan.points.cols();
        scan.points.conservativeResize(3, before + points.cols());
        scan.points.rightCols(points.cols()) = head.linear() * points.cast<double>();
        scan.times_s.insert(scan.times_s.end(), static_cast<std::size_t>(points.cols()), time_s);
    }
    return scan;
}
}  // namespace delio::test
