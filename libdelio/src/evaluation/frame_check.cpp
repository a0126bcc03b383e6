#include "delio/evaluation/frame_check.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "delio/evaluation/kitti_metric.h"

namespace delio::evaluation {
namespace {
constexpr double kStep_m = 1;         // long enough for a direction that noise does not hide
constexpr double kLeastStep_m = 0.2;  // of short paths: true poses are good to a few centimetres
constexpr int kStepsToTell = 3;       // fewer say too little
constexpr double kDisagree = 0.5;     // mean cosines
constexpr double kAgree = 0.9;

double metresBetween(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    return (b.translation() - a.translation()).norm();
}

/** How far apart poses have to be to give a direction: shorter where the path is short. */
double stepFor(const std::vector<Eigen::Isometry3d>& poses) {
    return std::clamp(pathLength_m(poses) / (2 * kStepsToTell), kLeastStep_m, kStep_m);
}

/** Where the moving frame went from pose `a` to pose `b`, in its own axes at `a`. */
Eigen::Vector3d direction(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    return (a.inverse() * b).translation().normalized();
}
}  // namespace

FrameMismatch findFrameMismatch(const std::vector<Eigen::Isometry3d>& reference,
                                const std::vector<Eigen::Isometry3d>& estimate) {
    Eigen::Matrix3d lidarToCamera;
    lidarToCamera << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    double asIs = 0, fromLidar = 0, fromCamera = 0;
    int steps = 0;
    std::size_t begin = 0;
    const double step_m = stepFor(reference);
    for (std::size_t i = 1; i < reference.size(); ++i) {
        if (metresBetween(reference[begin], reference[i]) < step_m) continue;
        const Eigen::Vector3d wanted = direction(reference[begin], reference[i]);
        const Eigen::Vector3d found = direction(estimate[begin], estimate[i]);
        asIs += wanted.dot(found);
        fromLidar += wanted.dot(lidarToCamera * found);
        fromCamera += wanted.dot(lidarToCamera.transpose() * found);
        ++steps;
        begin = i;
    }
    if (steps < kStepsToTell)
        return steps > 0 && asIs > kAgree * steps ? FrameMismatch::none : FrameMismatch::unknown;
    if (asIs >= kDisagree * steps) return FrameMismatch::none;
    if (fromLidar > kAgree * steps) return FrameMismatch::lidarAgainstCamera;
    if (fromCamera > kAgree * steps) return FrameMismatch::cameraAgainstLidar;
    return FrameMismatch::none;
}

bool movesAlongZ(const std::vector<Eigen::Isometry3d>& poses) {
    double alongX = 0, alongZ = 0;
    std::size_t begin = 0;
    for (std::size_t i = 1; i < poses.size(); ++i) {
        if (metresBetween(poses[begin], poses[i]) < kStep_m) continue;
        const Eigen::Vector3d step = direction(poses[begin], poses[i]);
        alongX += std::abs(step.x());
        alongZ += std::abs(step.z());
        begin = i;
    }
    return alongZ > alongX;
}
}  // namespace delio::evaluation
