#include "odometry/calibrate_extrinsics.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>

#include "delio/core/geometry.h"
#include "odometry/tuning.h"

namespace delio::odometry {
namespace {
/** Planes in the first sensor's frame at the time of each point: with them the sensor's pose is
 *  that of a registration. */
Correspondences matchesOf(const CalibrationView& view, const Eigen::Isometry3d& pose,
                          double kernel) {
    const auto placeOf = [&](Eigen::Index i) {
        return view.trajectory.at(view.times_s[static_cast<std::size_t>(i)]);
    };
    Eigen::Matrix3Xd placed(3, view.points.cols());
    for (Eigen::Index i = 0; i < placed.cols(); ++i)
        placed.col(i) = placeOf(i) * (pose * view.points.col(i).cast<double>());
    auto matches = Matcher(view.map, placed, plane_tuning::kPointSigma_m)
                       .at(Eigen::Isometry3d::Identity(), kernel);
    for (auto& match : matches) {
        const auto i = static_cast<Eigen::Index>(match.index);
        const Eigen::Isometry3d back = placeOf(i).inverse();
        match.point = view.points.col(i).cast<double>();
        match.normal = back.linear() * match.normal;
        match.mean = back * match.mean;
    }
    return matches;
}

/** Of each view. */
std::vector<Correspondences> matchesOf(const std::vector<CalibrationView>& views,
                                       const Eigen::Isometry3d& pose, double kernel) {
    std::vector<Correspondences> found(views.size());
    tbb::parallel_for(std::size_t{0}, views.size(),
                      [&](std::size_t i) { found[i] = matchesOf(views[i], pose, kernel); });
    return found;
}

/** Errors of a map are those of all points that meet it, and views that follow each other share
 *  parts of their maps: so much as the sums of groups of views scatter, so uncertain is the pose.
 *  H^-1 (sum g g') H^-1 over groups of views, with the normal equations H and gradients g. For what
 *  all views share, which does not scatter, comes H^-1: the noise of planes and points. */
Matrix6 scatterOf(const std::vector<Correspondences>& matches, const Eigen::Isometry3d& pose) {
    constexpr std::size_t kGroups = 24;
    const std::size_t groups = std::min(kGroups, matches.size());
    std::vector<NormalEquations<6>> sums(groups);
    const Eigen::Matrix3d R = pose.linear();
    for (std::size_t i = 0; i < matches.size(); ++i)
        for (const auto& match : matches[i]) {
            Vector6 jacobian;  // about the first sensor's axes
            jacobian << match.normal, (R * match.point).cross(match.normal);
            sums[i * groups / matches.size()].add(jacobian, match.residual(R, pose.translation()),
                                                  match.weight);
        }
    NormalEquations<6> all;
    Matrix6 scatter = Matrix6::Zero();
    for (const auto& sum : sums) all += sum;
    const Vector6 mean = all.gradient / static_cast<double>(groups);
    for (const auto& sum : sums)
        scatter += (sum.gradient - mean) * (sum.gradient - mean).transpose();
    scatter *= static_cast<double>(groups) / std::max(1.0, static_cast<double>(groups) - 6);
    const Matrix6 inverse = all.information.completeOrthogonalDecomposition().pseudoInverse();
    return inverse * scatter * inverse.transpose() + inverse;
}
}  // namespace

CalibratedPose calibrateExtrinsics(const std::vector<CalibrationView>& views,
                                   const Eigen::Isometry3d& given,
                                   const PlaneRegistrationOptions& options) {
    constexpr double kFirstKernel_m = 0.8;  // 1.5 deg at 30 m
    const auto find = [&](const Eigen::Isometry3d& pose, double kernel) {
        Correspondences all;
        for (const auto& found : matchesOf(views, pose, kernel))
            all.insert(all.end(), found.begin(), found.end());
        return all;
    };
    CalibratedPose result;
    result.estimate = registerByMatches(find, priorOf(given, options), kFirstKernel_m, options);
    if (!result.estimate.valid) return result;
    const Eigen::Isometry3d pose = result.estimate.pose();
    result.covariance = scatterOf(matchesOf(views, pose, options.last_kernel), pose);
    return result;
}
}  // namespace delio::odometry
