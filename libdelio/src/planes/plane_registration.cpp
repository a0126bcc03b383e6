#include "delio/planes/plane_registration.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "delio/planes/correspondence.h"
#include "delio/planes/plane_rotation.h"
#include "delio/planes/plane_translation.h"

namespace delio::planes {
namespace {
constexpr double kDeg = M_PI / 180;

/** With one kernel, until both stand still. Returns how often correspondences were sought. */
unsigned iterate(const PlaneMap& map, const Eigen::Matrix3Xd& points, double kernel,
                 const PlaneRegistrationOptions& options, Eigen::Isometry3d& pose) {
    for (unsigned i = 0; i < options.max_iterations; ++i) {
        const auto matches = findCorrespondences(map, points, pose, kernel, options.point_sigma);
        if (matches.size() < options.min_matches) return i + 1;
        const auto turn = rotationFromPlanes(matches, pose, options.min_rotation_share);
        pose.linear() = normalised(Eigen::Matrix3d(pose.linear() * rotationExp(turn.step)));
        const auto move = translationFromPlanes(matches, pose, options.min_translation_share);
        pose.translation() += move.step;
        if (turn.step.norm() < options.converged_rad && move.step.norm() < options.converged_m)
            return i + 1;
    }
    return options.max_iterations;
}

/** How well those points that fall into voxels with a plane lie on it, 0 to 1. What is seen for the
 *  first time does not count. */
double shareOnPlanes(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                     const Eigen::Isometry3d& pose, double kernel) {
    double sum = 0, count = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const Eigen::Vector3d placed = pose * points.col(i);
        const Plane* plane = map.at(placed);
        if (!plane) continue;
        const double r = plane->normal().dot(placed - plane->mean) / kernel;
        sum += 1 / (1 + r * r);
        count += 1;
    }
    return count > 0 ? sum / count : 0;
}

/** Variances from information on the axes that are seen, the motion model's on the others. */
template <typename Estimate>
Eigen::Matrix3d covarianceOf(const Eigen::Matrix3d& information, double least, double noise,
                             double prior, Estimate& estimate, Eigen::Matrix3d& inverseSeen) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(information);
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    inverseSeen = covariance;
    for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d axis = axes.eigenvectors().col(k);
        const Eigen::Matrix3d along = axis * axis.transpose();
        if (axes.eigenvalues()[k] > least) {
            inverseSeen += along / axes.eigenvalues()[k];
            covariance += noise / axes.eigenvalues()[k] * along;
        } else {
            estimate.unobservedAxes.conservativeResize(3, estimate.unobservedAxes.cols() + 1);
            estimate.unobservedAxes.rightCols(1) = axis;
            covariance += prior * along;
        }
    }
    return covariance;
}

/** Covariances and diagnostics of where the iteration ended. */
void settle(const Correspondences& matches, const Eigen::Isometry3d& pose,
            const PlaneRegistrationOptions& options, PlaneEstimate& estimate) {
    const auto turn = rotationFromPlanes(matches, pose, options.min_rotation_share);
    const auto move = translationFromPlanes(matches, pose, options.min_translation_share);
    const Eigen::Matrix3d R = pose.linear();
    const Eigen::Vector3d t = pose.translation();
    // The variance factor, as it turned out; points of one surface err together, so that only a
    // share of them counts.
    double weighted = 0, squared = 0;
    for (const auto& match : matches) {
        const double r = match.residual(R, t);
        weighted += match.weight * r * r;
        squared += r * r;
    }
    const auto count = static_cast<double>(matches.size());
    constexpr double kLeastFactor = 0.01;  // of simulated scans without any noise
    const double noise = std::max(weighted / count, kLeastFactor) / options.independent_share;
    Eigen::Matrix3d inverseSeen;
    auto& rotation = estimate.rotation;
    rotation.rotation = R;
    rotation.matches = matches.size();
    rotation.observability = turn.information.selfadjointView<Eigen::Lower>().eigenvalues() /
                             std::max(turn.weight, 1e-12);
    rotation.covariance = covarianceOf(
        turn.information, options.min_rotation_share * rotation.observability[2] * turn.weight,
        noise, std::pow(options.prior_sigma_deg * kDeg, 2), rotation, inverseSeen);
    rotation.valid = true;
    auto& translation = estimate.translation;
    translation.translation = t;
    translation.matches = matches.size();
    translation.observability = move.information.selfadjointView<Eigen::Lower>().eigenvalues() /
                                std::max(move.weight, 1e-12);
    translation.covariance =
        covarianceOf(move.information, options.min_translation_share * move.weight, noise,
                     options.prior_sigma * options.prior_sigma, translation, inverseSeen);
    // t follows an error w of the rotation by -H_tt^-1 H_tr w, where it is seen at all; here w is
    // about the map's axes.
    translation.lever = -inverseSeen * move.mixed * R.transpose();
    translation.valid = true;
    translation.residual_m = std::sqrt(squared / count);
    rotation.residual_rad = 0;
    estimate.valid = true;
}
}  // namespace

std::vector<OptionField> PlaneRegistrationOptions::fields() const {
    return {
        {"first_kernel", &PlaneRegistrationOptions::first_kernel,
         "m; widest kernel of the residuals; it follows the error of the motion model up to this",
         1e-3, 100},
        {"last_kernel", &PlaneRegistrationOptions::last_kernel,
         "m; width to which the kernel is halved", 1e-3, 100},
        {"point_sigma", &PlaneRegistrationOptions::point_sigma, "m; a point's own error", 0, 1},
        {"max_iterations", &PlaneRegistrationOptions::max_iterations,
         "matchings with one kernel at most", 1, 10000},
        {"converged_rad", &PlaneRegistrationOptions::converged_rad, "rad; smaller turns and", 0, 1},
        {"converged_m", &PlaneRegistrationOptions::converged_m,
         "m; smaller moves end the iteration", 0, 1},
        {"min_matches", &PlaneRegistrationOptions::min_matches,
         "points on planes that are needed; fewer: predicted", 6, 1e6},
        {"min_rotation_share", &PlaneRegistrationOptions::min_rotation_share,
         "share of the best seen axis' information; an axis with less keeps the prediction", 0, 1},
        {"min_translation_share", &PlaneRegistrationOptions::min_translation_share,
         "share of the weight; a direction that is seen with less keeps the prediction", 0, 1},
        {"independent_share", &PlaneRegistrationOptions::independent_share,
         "share of the points that count as independent in the covariance", 1e-6, 1},
        {"prior_sigma", &PlaneRegistrationOptions::prior_sigma,
         "m; the motion model's error along such a direction", 1e-6, 100},
        {"prior_sigma_deg", &PlaneRegistrationOptions::prior_sigma_deg,
         "deg; the same about such an axis", 1e-6, 180},
        {"search_speed", &PlaneRegistrationOptions::search_speed,
         "m/s; where the motion is not known, what can be driven at this speed is searched", 0,
         1000},
        {"search_radius", &PlaneRegistrationOptions::search_radius, "m; but no farther than this",
         0, 100},
        {"search_step", &PlaneRegistrationOptions::search_step,
         "m; distance between the starts of that search", 0.5, 50}};
}

void PlaneRegistrationOptions::check(const std::string& section) const {
    // The kernel starts between twice its last width and its first one.
    requireOrder("twice " + section + ".last_kernel", 2 * last_kernel, section + ".first_kernel",
                 first_kernel);
}

PlaneEstimate predictedEstimate(const Eigen::Isometry3d& pose,
                                const PlaneRegistrationOptions& options) {
    PlaneEstimate estimate;
    estimate.rotation.rotation = pose.linear();
    estimate.rotation.covariance =
        std::pow(options.prior_sigma_deg * kDeg, 2) * Eigen::Matrix3d::Identity();
    estimate.rotation.unobservedAxes = Eigen::Matrix3d::Identity();
    estimate.translation.translation = pose.translation();
    estimate.translation.covariance =
        options.prior_sigma * options.prior_sigma * Eigen::Matrix3d::Identity();
    estimate.translation.unobservedAxes = Eigen::Matrix3d::Identity();
    return estimate;
}

PlaneEstimate registerToPlanes(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                               const Eigen::Isometry3d& predicted, double kernel,
                               const PlaneRegistrationOptions& options) {
    PlaneEstimate estimate;
    Eigen::Isometry3d pose = predicted;
    unsigned iterations = 0;
    for (double width = std::max(kernel, options.last_kernel);;
         width = std::max(width / 2, options.last_kernel)) {
        iterations += iterate(map, points, width, options, pose);
        if (width <= options.last_kernel) break;
    }
    const auto matches =
        findCorrespondences(map, points, pose, options.last_kernel, options.point_sigma);
    if (matches.size() >= options.min_matches) {
        settle(matches, pose, options, estimate);
        estimate.rotation.iterations = iterations;
        estimate.share = shareOnPlanes(map, points, pose, options.last_kernel);
        return estimate;
    }
    return predictedEstimate(predicted, options);
}
}  // namespace delio::planes
