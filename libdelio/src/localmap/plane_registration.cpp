#include "delio/localmap/plane_registration.h"

#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "delio/rotation/plane_rotation.h"
#include "delio/translation/plane_translation.h"

namespace delio::localmap {
namespace {
constexpr double kDeg = M_PI / 180;
/** Points farther from a plane than so many kernel widths do not belong to it. */
constexpr double kReach = 3;

Eigen::Matrix3d turned(const Eigen::Matrix3d& R, const Eigen::Vector3d& w) {
    const double angle = w.norm();
    if (angle == 0) return R;
    const Eigen::Quaterniond q(R * Eigen::AngleAxisd(angle, w / angle).toRotationMatrix());
    return q.normalized().toRotationMatrix();
}

struct Pose {
    Eigen::Matrix3d R;
    Eigen::Vector3d t;
};

/** With one kernel, until both stand still. Returns how often points were matched. */
unsigned iterate(const PlaneMap& map, const Eigen::Matrix3Xd& points, double kernel,
                 unsigned max_iterations, const PlaneRegistrationOptions& options, Pose& pose) {
    for (unsigned i = 0; i < max_iterations; ++i) {
        const auto matches = matchPlanes(map, points, pose.R, pose.t, kernel, options.point_sigma);
        if (matches.size() < options.min_matches) return i + 1;
        const auto turn =
            rotation::rotationFromPlanes(matches, pose.R, pose.t, options.min_rotation_share);
        pose.R = turned(pose.R, turn.step);
        const auto move = translation::translationFromPlanes(matches, pose.R, pose.t,
                                                             options.min_translation_share);
        pose.t += move.step;
        if (turn.step.norm() < options.converged_rad && move.step.norm() < options.converged_m)
            return i + 1;
    }
    return max_iterations;
}

/** How well those points that fall into voxels with a plane lie on it, 0 to 1. What is seen for the
 *  first time does not count. */
double shareOnPlanes(const PlaneMap& map, const Eigen::Matrix3Xd& points, const Pose& pose,
                     double kernel) {
    double sum = 0, count = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const Eigen::Vector3d placed = pose.R * points.col(i) + pose.t;
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
void settle(const PlaneMatches& matches, const Pose& pose, const PlaneRegistrationOptions& options,
            PlaneEstimate& estimate) {
    const auto turn =
        rotation::rotationFromPlanes(matches, pose.R, pose.t, options.min_rotation_share);
    const auto move =
        translation::translationFromPlanes(matches, pose.R, pose.t, options.min_translation_share);
    // The variance factor, as it turned out; points of one surface err together, so that only a
    // share of them counts.
    double weighted = 0, squared = 0;
    for (const auto& match : matches) {
        const double r = match.residual(pose.R, pose.t);
        weighted += match.weight * r * r;
        squared += r * r;
    }
    const auto count = static_cast<double>(matches.size());
    constexpr double kLeastFactor = 0.01;  // of simulated scans without any noise
    const double noise = std::max(weighted / count, kLeastFactor) / options.independent_share;
    Eigen::Matrix3d inverseSeen;
    auto& rotation = estimate.rotation;
    rotation.rotation = pose.R;
    rotation.matches = matches.size();
    rotation.observability = turn.information.selfadjointView<Eigen::Lower>().eigenvalues() /
                             std::max(turn.weight, 1e-12);
    rotation.covariance = covarianceOf(
        turn.information, options.min_rotation_share * rotation.observability[2] * turn.weight,
        noise, std::pow(options.prior_sigma_deg * kDeg, 2), rotation, inverseSeen);
    rotation.valid = true;
    auto& translation = estimate.translation;
    translation.translation = pose.t;
    translation.matches = matches.size();
    translation.observability = move.information.selfadjointView<Eigen::Lower>().eigenvalues() /
                                std::max(move.weight, 1e-12);
    translation.covariance =
        covarianceOf(move.information, options.min_translation_share * move.weight, noise,
                     options.prior_sigma * options.prior_sigma, translation, inverseSeen);
    // t follows an error w of the rotation by -H_tt^-1 H_tr w, where it is seen at all; here w is
    // about the map's axes.
    translation.lever = -inverseSeen * move.mixed * pose.R.transpose();
    translation.valid = true;
    translation.residual_m = std::sqrt(squared / count);
    rotation.residual_rad = 0;
    estimate.valid = true;
}
}  // namespace

std::vector<OptionField> PlaneRegistrationOptions::fields() {
    return {
        {"first_kernel", &first_kernel,
         "m; widest kernel of the residuals; it follows the error of the motion model up to this",
         1e-3, 100},
        {"last_kernel", &last_kernel, "m; width to which the kernel is halved", 1e-3, 100},
        {"point_sigma", &point_sigma, "m; a point's own error", 0, 1},
        {"max_iterations", &max_iterations, "matchings with one kernel at most", 1, 10000},
        {"converged_rad", &converged_rad, "rad; smaller turns and", 0, 1},
        {"converged_m", &converged_m, "m; smaller moves end the iteration", 0, 1},
        {"min_matches", &min_matches, "points on planes that are needed; fewer: predicted", 6, 1e6},
        {"min_rotation_share", &min_rotation_share,
         "share of the best seen axis' information; an axis with less keeps the prediction", 0, 1},
        {"min_translation_share", &min_translation_share,
         "share of the weight; a direction that is seen with less keeps the prediction", 0, 1},
        {"independent_share", &independent_share,
         "share of the points that count as independent in the covariance", 1e-6, 1},
        {"prior_sigma", &prior_sigma, "m; the motion model's error along such a direction", 1e-6,
         100},
        {"prior_sigma_deg", &prior_sigma_deg, "deg; the same about such an axis", 1e-6, 180},
        {"search_speed", &search_speed,
         "m/s; where the motion is not known, what can be driven at this speed is searched", 0,
         1000},
        {"search_radius", &search_radius, "m; but no farther than this", 0, 100},
        {"search_step", &search_step, "m; distance between the starts of that search", 0.5, 50}};
}

PlaneMatches matchPlanes(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                         const Eigen::Matrix3d& R, const Eigen::Vector3d& t, double kernel,
                         double point_sigma) {
    std::vector<PlaneMatch> all(static_cast<std::size_t>(points.cols()));
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, all.size(), 512),
        [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                const Eigen::Vector3d point = points.col(static_cast<Eigen::Index>(i));
                const Eigen::Vector3d placed = R * point + t;
                const Plane* plane = map.at(placed);
                if (!plane) continue;
                const double r = plane->normal().dot(placed - plane->mean);
                if (std::abs(r) > kReach * kernel) continue;
                const double robust = 1 / (1 + r * r / (kernel * kernel));
                all[i] = {
                    point, plane->normal(), plane->mean,
                    robust * robust / (plane->varianceAt(placed) + point_sigma * point_sigma)};
            }
        });
    all.erase(std::remove_if(all.begin(), all.end(),
                             [](const PlaneMatch& match) { return match.weight == 0; }),
              all.end());
    return all;
}

PlaneEstimate predictedEstimate(const Eigen::Matrix3d& R, const Eigen::Vector3d& t,
                                const PlaneRegistrationOptions& options) {
    PlaneEstimate estimate;
    estimate.rotation.rotation = R;
    estimate.rotation.covariance =
        std::pow(options.prior_sigma_deg * kDeg, 2) * Eigen::Matrix3d::Identity();
    estimate.rotation.unobservedAxes = Eigen::Matrix3d::Identity();
    estimate.translation.translation = t;
    estimate.translation.covariance =
        options.prior_sigma * options.prior_sigma * Eigen::Matrix3d::Identity();
    estimate.translation.unobservedAxes = Eigen::Matrix3d::Identity();
    return estimate;
}

PlaneEstimate registerToPlanes(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                               const Eigen::Matrix3d& R, const Eigen::Vector3d& t, double kernel,
                               const PlaneRegistrationOptions& options) {
    PlaneEstimate estimate;
    Pose pose{R, t};
    unsigned iterations = 0;
    for (double width = std::max(kernel, options.last_kernel);;
         width = std::max(width / 2, options.last_kernel)) {
        iterations += iterate(map, points, width, options.max_iterations, options, pose);
        if (width <= options.last_kernel) break;
    }
    const auto matches =
        matchPlanes(map, points, pose.R, pose.t, options.last_kernel, options.point_sigma);
    if (matches.size() >= options.min_matches) {
        settle(matches, pose, options, estimate);
        estimate.rotation.iterations = iterations;
        estimate.share = shareOnPlanes(map, points, pose, options.last_kernel);
        return estimate;
    }
    return predictedEstimate(R, t, options);
}

double agreement(const PlaneMap& map, const rotation::SurfaceNormals& surfaces,
                 const Eigen::Matrix3d& R, const Eigen::Vector3d& t, double kernel) {
    constexpr double kSameWay = 0.95;  // cosine
    Eigen::Matrix3d all = Eigen::Matrix3d::Zero(), found = all;
    for (Eigen::Index i = 0; i < surfaces.points.cols(); ++i) {
        const Eigen::Vector3d normal = R * surfaces.directions.col(i).cast<double>();
        all += normal * normal.transpose();
        const Eigen::Vector3d placed = R * surfaces.points.col(i).cast<double>() + t;
        const Plane* plane = map.at(placed);
        if (!plane || std::abs(plane->normal().dot(normal)) < kSameWay) continue;
        const double r = plane->normal().dot(placed - plane->mean) / kernel;
        found += normal * normal.transpose() / (1 + r * r);
    }
    // The trace of all^-1 found: each direction's share of what could be found there.
    return all.completeOrthogonalDecomposition().solve(found).trace() / 3;
}

PlaneEstimate searchInPlanes(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                             const rotation::SurfaceNormals& surfaces, const Eigen::Matrix3d& R,
                             const Eigen::Vector3d& centre, double radius,
                             const PlaneRegistrationOptions& options) {
    constexpr std::size_t kBest = 12;
    const int steps = static_cast<int>(radius / options.search_step);
    std::vector<std::pair<double, Eigen::Vector3d>> starts;
    for (int x = -steps; x <= steps; ++x)
        for (int y = -steps; y <= steps; ++y) {
            const Eigen::Vector3d offset(x * options.search_step, y * options.search_step, 0);
            if (offset.norm() <= radius) starts.emplace_back(0, centre + offset);
        }
    tbb::parallel_for(std::size_t{0}, starts.size(), [&](std::size_t i) {
        starts[i].first = agreement(map, surfaces, R, starts[i].second, options.search_step / 2);
    });
    std::stable_sort(starts.begin(), starts.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    if (starts.size() > kBest) starts.resize(kBest);
    starts.emplace_back(0, centre);
    PlaneEstimate best;
    double bestAgreement = -1;
    for (const auto& [rough, t] : starts) {
        const auto found = registerToPlanes(map, points, R, t, options.search_step, options);
        const double agreed = agreement(map, surfaces, found.rotation.rotation,
                                        found.translation.translation, 2 * options.last_kernel);
        if (agreed <= bestAgreement) continue;
        best = found;
        bestAgreement = agreed;
    }
    return best;
}
}  // namespace delio::localmap
