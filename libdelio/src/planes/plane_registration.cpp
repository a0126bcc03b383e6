#include "delio/planes/plane_registration.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "delio/planes/correspondence.h"
#include "delio/planes/plane_rotation.h"
#include "delio/planes/plane_translation.h"
#include "sum_over.h"

namespace delio::planes {
namespace {
constexpr double kDeg = M_PI / 180;

/** Variance factor of the weights, as it turned out. Points of one surface err together, so that
 *  only a share of them counts. */
double varianceFactor(const Correspondences& matches, const Eigen::Isometry3d& pose,
                      double independent_share) {
    const Eigen::Matrix3d R = pose.linear();
    const Eigen::Vector3d t = pose.translation();
    const double weighted = sumOver<double>(matches, [&](const Correspondence& match, double& sum) {
        const double r = match.residual(R, t);
        sum += match.weight * r * r;
    });
    constexpr double kLeast = 0.01;  // of simulated scans without any noise
    return std::max(weighted / static_cast<double>(matches.size()), kLeast) / independent_share;
}

/** What an iteration has come to. */
struct Iterate {
    Eigen::Isometry3d pose;
    Correspondences matches;  //!< of the pose before the latest step
    unsigned iterations = 0;  //!< how often correspondences were sought
};

/** True where iterations come by a pose again: they go round between matches that exclude each
 *  other, and would for ever. */
bool isAmong(const std::vector<Eigen::Isometry3d>& poses, const Eigen::Isometry3d& pose,
             const PlaneRegistrationOptions& options) {
    return std::any_of(poses.begin(), poses.end(), [&](const Eigen::Isometry3d& other) {
        const Eigen::Isometry3d off = other.inverse() * pose;
        return off.translation().norm() < options.converged_m &&
               angleOf(off.linear()) < options.converged_rad;
    });
}

/** With one kernel, until both stand still. False where they do not. */
bool iterate(Matcher& matcher, const Prior& known, double kernel,
             const PlaneRegistrationOptions& options, Iterate& now) {
    auto& [pose, matches, iterations] = now;
    std::vector<Eigen::Isometry3d> passed;
    for (unsigned i = 0; i < options.max_iterations; ++i) {
        ++iterations;
        matches = matcher.at(pose, kernel);
        if (matches.size() < options.min_matches) return false;
        const Prior prior = known.times(varianceFactor(matches, pose, options.independent_share));
        const auto turn = rotationFromPlanes(matches, pose, prior);
        pose.linear() = normalised(Eigen::Matrix3d(pose.linear() * rotationExp(turn.step)));
        const Eigen::Vector3d move = stepFromPlanes(matches, pose, prior);
        pose.translation() += move;
        if (turn.step.norm() < options.converged_rad && move.norm() < options.converged_m)
            return true;
        if (isAmong(passed, pose, options)) return false;
        passed.push_back(pose);
    }
    return false;
}

/** Unit axes along which `information` is no better than what was known before. */
Eigen::Matrix3Xd unobservedAxes(const Eigen::Matrix3d& information, const Eigen::Matrix3d& before) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(information);
    const auto isSeen = [&](Eigen::Index i) {
        const Eigen::Vector3d axis = axes.eigenvectors().col(i);
        return axes.eigenvalues()[i] > axis.dot(before * axis);
    };
    // Eigenvalues rise.
    Eigen::Index count = 0;
    while (count < 3 && !isSeen(count)) ++count;
    return axes.eigenvectors().leftCols(count);
}

/** Eigenvalues, rising, as shares of the weight. */
Eigen::Vector3d shares(const Eigen::Matrix3d& information, double weight) {
    return information.selfadjointView<Eigen::Lower>().eigenvalues() / std::max(weight, 1e-12);
}

/** Of the prior's information counts so much in covariances: it comes from the same points. */
constexpr double kPriorShare = 0.01;

/** Of the information about the translation (of which `alone` is what there is with the rotation
 *  known) what the rotation's own uncertainty takes: H_tr H_rr^-1 H_rt. The height over a patch of
 *  ground that lies on one side only is no better known than the tilt. */
Eigen::Matrix3d lostToRotation(const PlaneRotation& turn, const PlaneTranslation& move,
                               const Prior& prior, const Eigen::Matrix3d& alone) {
    const Eigen::Matrix3d Hrt = move.mixed.transpose(),
                          Hrr = turn.information + Hrt * alone.inverse() * move.mixed;
    return move.mixed * (Hrr + prior.rotation).inverse() * Hrt;
}

/** Covariances and diagnostics of where the iteration ended. */
void settle(const Correspondences& matches, const Eigen::Isometry3d& pose, const Prior& known,
            const PlaneRegistrationOptions& options, PlaneEstimate& estimate) {
    const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity(), R = pose.linear();
    const double noise = varianceFactor(matches, pose, options.independent_share);
    const Prior prior = known.times(noise);
    const auto turn = rotationFromPlanes(matches, pose, prior);
    const auto move = translationFromPlanes(matches, pose, prior);
    auto& rotation = estimate.rotation;
    rotation.rotation = R;
    rotation.matches = matches.size();
    rotation.observability = shares(turn.information, turn.weight);
    rotation.unobservedAxes = unobservedAxes(turn.information, prior.rotation);
    rotation.covariance = noise * (turn.information + kPriorShare * prior.rotation).inverse();
    rotation.valid = true;
    auto& translation = estimate.translation;
    translation.matches = matches.size();
    translation.observability = shares(move.information, move.weight);
    // Normals are known from no more independent points than residuals are; and where an edge was
    // taken for a plane, worse.
    constexpr double kEdges = 3;
    const Eigen::Matrix3d priorHere = prior.translation * identity,
                          alone = move.information + kPriorShare * priorHere,
                          clear = move.information -
                                  kEdges / options.independent_share * move.pretended;
    const auto unseen = unobservedAxes(clear, priorHere);
    translation.unobservedAxes =
        unobservedAxes(clear - lostToRotation(turn, move, prior, alone), priorHere);
    const Eigen::Matrix3d before = unseen * unseen.transpose(), seen = identity - before,
                          inverse = seen * alone.inverse() * seen;
    translation.translation = seen * pose.translation() + before * known.pose.translation();
    translation.covariance = noise * inverse + before / known.translation;
    // t follows an error w of the rotation by -H_tt^-1 H_tr w, where it is seen at all; here w is
    // about the map's axes.
    translation.lever = -inverse * move.mixed * R.transpose();
    translation.valid = true;
    double squared = 0;
    for (const auto& match : matches)
        squared += std::pow(match.residual(R, translation.translation), 2);
    translation.residual_m = std::sqrt(squared / static_cast<double>(matches.size()));
    estimate.valid = true;
}
}  // namespace

std::vector<OptionField> PlaneRegistrationOptions::fields() const {
    return {
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
        {"independent_share", &PlaneRegistrationOptions::independent_share,
         "share of the points that count as independent in the covariance", 1e-6, 1},
        {"prior_sigma", &PlaneRegistrationOptions::prior_sigma,
         "m; the motion model's error along each axis in 0.1 s; in more time more", 1e-6, 100},
        {"prior_sigma_deg", &PlaneRegistrationOptions::prior_sigma_deg,
         "deg; the same about each axis", 1e-6, 180},
        {"search_speed", &PlaneRegistrationOptions::search_speed,
         "m/s; where the motion is not known, what can be driven at this speed is searched", 0,
         1000},
        {"search_radius", &PlaneRegistrationOptions::search_radius, "m; but no farther than this",
         0, 100},
        {"search_step", &PlaneRegistrationOptions::search_step,
         "m; distance between the starts of that search", 0.5, 50}};
}

PlaneEstimate predictedEstimate(const Eigen::Isometry3d& pose,
                                const PlaneRegistrationOptions& options, double growth) {
    PlaneEstimate estimate;
    estimate.rotation.rotation = pose.linear();
    estimate.rotation.covariance =
        std::pow(growth * options.prior_sigma_deg * kDeg, 2) * Eigen::Matrix3d::Identity();
    estimate.rotation.unobservedAxes = Eigen::Matrix3d::Identity();
    estimate.translation.translation = pose.translation();
    estimate.translation.covariance =
        std::pow(growth * options.prior_sigma, 2) * Eigen::Matrix3d::Identity();
    estimate.translation.unobservedAxes = Eigen::Matrix3d::Identity();
    return estimate;
}

Prior priorOf(const Eigen::Isometry3d& predicted, const PlaneRegistrationOptions& options) {
    return Prior::of(predicted, options.prior_sigma,
                     std::pow(options.prior_sigma_deg * kDeg, 2) * Eigen::Matrix3d::Identity());
}

PlaneEstimate registerToPlanes(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                               const Prior& prior, double kernel,
                               const PlaneRegistrationOptions& options) {
    Matcher matcher(map, points, options.point_sigma);
    Iterate now{prior.pose, {}};
    bool converged = false;
    for (double width = std::max(kernel, options.last_kernel);;
         width = std::max(width / 2, options.last_kernel)) {
        converged = iterate(matcher, prior, width, options, now);
        if (width <= options.last_kernel) break;
    }
    if (now.matches.size() < options.min_matches) return predictedEstimate(prior.pose, options);
    PlaneEstimate estimate;
    settle(now.matches, now.pose, prior, options, estimate);
    estimate.rotation.iterations = now.iterations;
    estimate.rotation.converged = converged;
    estimate.share = matcher.shareAt(now.pose, options.last_kernel);
    return estimate;
}
}  // namespace delio::planes
