#include "coupled_registration.h"

#include <Eigen/Dense>
#include <vector>

#include "delio/core/geometry.h"
#include "paper/line_registration.h"

namespace delio::paper {
CoupledEstimate registerCoupled(const LineCloud& from, const LineCloud& to,
                                const Eigen::Isometry3d& predicted,
                                const LineRegistrationOptions& options) {
    CoupledEstimate estimate;
    estimate.pose = predicted;
    LineMatcher matcher(from);
    while (estimate.iterations < options.max_iterations) {
        const LineCloud turned = rotated(to, estimate.pose.linear());
        const Eigen::Vector3d t = estimate.pose.translation();
        const auto matches = matcher.matches(turned, t, options.max_distance);
        const double mean = meanDistance(matches);
        std::vector<Eigen::Vector3d> sources, targets;
        for (std::size_t i = 0; i < matches.size(); ++i) {
            if (matches[i].distance < 0 || static_cast<double>(matches[i].distance) > mean)
                continue;
            const auto s = static_cast<Eigen::Index>(i);
            const auto f = static_cast<Eigen::Index>(matches[i].from);
            const auto closest = closestPoints(
                turned.midpoints.col(s).cast<double>() + t, turned.directions.col(s).cast<double>(),
                from.midpoints.col(f).cast<double>(), from.directions.col(f).cast<double>(),
                options.min_angle_deg);
            sources.push_back(closest.onSource);
            targets.push_back(closest.onTarget);
        }
        estimate.matches = sources.size();
        estimate.valid = estimate.matches >= options.min_matches;
        if (!estimate.valid) break;
        ++estimate.iterations;
        const auto pairs = static_cast<Eigen::Index>(sources.size());
        const Eigen::Matrix4d step =
            Eigen::umeyama(Eigen::Map<const Eigen::Matrix3Xd>(sources[0].data(), 3, pairs),
                           Eigen::Map<const Eigen::Matrix3Xd>(targets[0].data(), 3, pairs), false);
        estimate.pose = Eigen::Isometry3d(step) * estimate.pose;
        estimate.pose.linear() = Eigen::Quaterniond(estimate.pose.linear()).normalized().matrix();
        const double turn = angleOf(step.topLeftCorner<3, 3>());
        // At 10 m a turn by 1e-4 rad is one millimetre.
        if (step.topRightCorner<3, 1>().norm() < options.converged && turn < 1e-4) break;
    }
    if (!estimate.valid) estimate.pose = predicted;
    return estimate;
}
}  // namespace delio::paper
