#include "odometry/register_planes.h"
#include "odometry/tuning.h"

#include <tbb/parallel_for.h>
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "delio/core/geometry.h"
#include "odometry/sectors.h"

namespace delio::odometry {
Matcher::Matcher(const PlaneMap& map, const Eigen::Matrix3Xd& points, double point_sigma)
    : map_(map),
      points_(points),
      point_sigma_(point_sigma),
      latest_(static_cast<std::size_t>(points.cols())) {}

Matcher::Placed Matcher::placedBy(const Eigen::Isometry3d& pose, std::size_t block) const {
    const std::size_t first = block * kBlock;
    Placed placed =
        pose.linear() * points_.middleCols(static_cast<Eigen::Index>(first),
                                           static_cast<Eigen::Index>(endOf(block) - first));
    placed.colwise() += pose.translation();
    return placed;
}

/** The planes about a block's points. Each step is done for all of them before the next. */
void Matcher::findPlanes(std::size_t block, const Placed& placed) {
    const std::size_t first = block * kBlock;
    std::array<std::size_t, kBlock> moved;
    std::array<PlaneMap::Cells, kBlock> cells;
    std::size_t count = 0;
    for (std::size_t i = first; i < endOf(block); ++i) {
        const std::uint64_t voxel = map_.voxelAt(placed.col(static_cast<Eigen::Index>(i - first)));
        if (voxel == latest_[i].voxel) continue;
        latest_[i].voxel = voxel;
        map_.prefetch(voxel);
        moved[count++] = i;
    }
    for (std::size_t k = 0; k < count; ++k) cells[k] = map_.cellsAbout(latest_[moved[k]].voxel);
    for (std::size_t k = 0; k < count; ++k) map_.prefetchPlane(cells[k]);
    for (std::size_t k = 0; k < count; ++k) {
        Place& place = latest_[moved[k]];
        place.plane = map_.planeIn(place.voxel, cells[k]);
    }
}

Correspondences Matcher::at(const Eigen::Isometry3d& pose, double kernel) {
    std::vector<Correspondences> found(blocks());
    tbb::parallel_for(std::size_t{0}, blocks(), [&](std::size_t block) {
        const Placed placed = placedBy(pose, block);
        findPlanes(block, placed);
        auto& matches = found[block];
        matches.reserve(kBlock);
        forMatches(block, placed, kernel,
                   [&](std::size_t i, const auto&, const Plane& plane, double weight) {
                       matches.push_back({points_.col(static_cast<Eigen::Index>(i)), plane.normal(),
                                          plane.mean, weight, plane.tilt(), i});
                   });
    });
    std::vector<std::size_t> firsts(blocks());
    std::size_t count = 0;
    for (std::size_t block = 0; block < blocks(); ++block) {
        firsts[block] = count;
        count += found[block].size();
    }
    Correspondences all(count);
    tbb::parallel_for(std::size_t{0}, blocks(), [&](std::size_t block) {
        std::copy(found[block].begin(), found[block].end(),
                  all.begin() + static_cast<std::ptrdiff_t>(firsts[block]));
    });
    return all;
}

double Matcher::shareAt(const Eigen::Isometry3d& pose, double kernel) {
    struct Share {
        double sum = 0, count = 0;
    };
    std::vector<Share> shares(blocks());
    tbb::parallel_for(std::size_t{0}, blocks(), [&](std::size_t block) {
        const Placed placed = placedBy(pose, block);
        findPlanes(block, placed);
        Share share;
        for (Eigen::Index i = 0; i < placed.cols(); ++i) {
            const Plane* plane = latest_[block * kBlock + static_cast<std::size_t>(i)].plane;
            if (!plane) continue;
            const double r = plane->normal().dot(placed.col(i) - plane->mean) / kernel;
            share.sum += 1 / (1 + r * r);
            ++share.count;
        }
        shares[block] = share;
    });
    Share all;
    for (const Share& share : shares) {
        all.sum += share.sum;
        all.count += share.count;
    }
    return all.count > 0 ? all.sum / all.count : 0;
}

namespace {
/** By rotation (right tangent) and by translation. */
NormalEquations<6> equationsOf(const Correspondences& matches, const Eigen::Isometry3d& pose) {
    const Eigen::Matrix3d R = pose.linear();
    const Eigen::Vector3d t = pose.translation();
    using Equations = NormalEquations<6>;
    return sumOver<Equations>(matches, [&](const Correspondence& match, Equations& sum) {
        Vector6 jacobian;
        jacobian << match.point.cross(R.transpose() * match.normal), match.normal;
        sum.add(jacobian, match.residual(R, t), match.weight);
    });
}

PlaneRotation rotationFrom(const NormalEquations<6>& equations, const Eigen::Isometry3d& pose,
                           const Prior& prior) {
    const Eigen::Matrix3d R = pose.linear();
    const Eigen::Vector3d t = pose.translation();
    PlaneRotation result;
    result.weight = equations.weight;
    const Matrix6& H = equations.information;
    const Eigen::Matrix3d rr = H.topLeftCorner<3, 3>(), rt = H.topRightCorner<3, 3>();
    const Eigen::Vector3d gr = equations.gradient.head<3>();
    Eigen::Matrix3d tt = H.bottomRightCorner<3, 3>();
    Eigen::Vector3d gt = equations.gradient.tail<3>();
    tt += prior.translation * Eigen::Matrix3d::Identity();
    gt += prior.translation * (t - prior.pose.translation());
    // Directions that no normal looks along constrain nothing: the pseudo-inverse leaves them out.
    const Eigen::Matrix3d free = rt * tt.completeOrthogonalDecomposition().pseudoInverse();
    result.information = rr - free * rt.transpose();
    const Eigen::Vector3d gradient =
        gr - free * gt + prior.rotation * rotationLog(prior.pose.linear().transpose() * R);
    const Eigen::Matrix3d all = result.information + prior.rotation;
    result.step = -all.completeOrthogonalDecomposition().solve(gradient);
    return result;
}
}  // namespace

PlaneRotation rotationFromPlanes(const Correspondences& matches, const Eigen::Isometry3d& pose,
                                 const Prior& prior) {
    return rotationFrom(equationsOf(matches, pose), pose, prior);
}

namespace {
/** Without the step. */
PlaneTranslation translationInformation(const Correspondences& matches, const Eigen::Matrix3d& R) {
    return sumOver<PlaneTranslation>(
        matches, [&](const Correspondence& match, PlaneTranslation& sum) {
            const Eigen::Vector3d& n = match.normal;
            const Eigen::Vector3d a = match.point.cross(R.transpose() * n);
            const Eigen::Matrix3d along = n * n.transpose();
            sum.information += match.weight * along;
            sum.pretended += match.weight * match.tilt * (Eigen::Matrix3d::Identity() - along);
            sum.mixed += match.weight * n * a.transpose();
            sum.weight += match.weight;
        });
}
}  // namespace

PlaneTranslation translationFromPlanes(const Correspondences& matches,
                                       const Eigen::Isometry3d& pose, const Prior& prior) {
    auto result = translationInformation(matches, pose.linear());
    result.step = stepFromPlanes(matches, pose, prior);
    return result;
}

Eigen::Vector3d stepFromPlanes(const Correspondences& matches, const Eigen::Isometry3d& pose,
                               const Prior& prior) {
    const Eigen::Matrix3d R = pose.linear();
    const Eigen::Vector3d t = pose.translation();
    using Equations = NormalEquations<3>;
    const auto equations =
        sumOver<Equations>(matches, [&](const Correspondence& match, Equations& sum) {
            sum.add(match.normal, match.residual(R, t), match.weight);
        });
    const Eigen::Vector3d gradient =
        equations.gradient + prior.translation * (t - prior.pose.translation());
    const Eigen::Matrix3d& H = equations.information;
    Eigen::Matrix3d information;               // symmetric to the last bit
    information << H(0, 0), H(0, 1), H(2, 0),  //
        H(0, 1), H(1, 1), H(1, 2),             //
        H(2, 0), H(1, 2), H(2, 2);
    const Eigen::Matrix3d all = information + prior.translation * Eigen::Matrix3d::Identity();
    return -all.completeOrthogonalDecomposition().solve(gradient);
}

namespace {
constexpr double kDeg = M_PI / 180;

/** Variance factor of the weights, from the sum of weighted squares. Points of one surface err
 *  together, so that only a share of them counts. */
double varianceFactor(double cost, std::size_t matches) {
    constexpr double kLeast = 0.01;  // of simulated scans without any noise
    return std::max(cost / static_cast<double>(matches), kLeast) / plane_tuning::kIndependentRatio;
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
               angleOf(off.linear()) < plane_tuning::kConverged_rad;
    });
}

/** With one kernel, until both stand still. False where they do not. */
bool iterate(const FindMatches& find, const Prior& known, double kernel,
             const PlaneRegistrationOptions& options, Iterate& now) {
    auto& [pose, matches, iterations] = now;
    std::vector<Eigen::Isometry3d> passed;
    for (unsigned i = 0; i < options.max_iterations; ++i) {
        ++iterations;
        matches = find(pose, kernel);
        if (matches.size() < options.min_matches) return false;
        const auto equations = equationsOf(matches, pose);
        const Prior prior = known.times(varianceFactor(equations.cost, matches.size()));
        const auto turn = rotationFrom(equations, pose, prior);
        pose.linear() = normalised(Eigen::Matrix3d(pose.linear() * rotationExp(turn.step)));
        const Eigen::Vector3d move = stepFromPlanes(matches, pose, prior);
        pose.translation() += move;
        if (turn.step.norm() < plane_tuning::kConverged_rad && move.norm() < options.converged_m)
            return true;
        if (isAmong(passed, pose, options)) return false;
        passed.push_back(pose);
    }
    return false;
}

/** Unit axes along which `information` is no better than `before`. */
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
            PlaneEstimate& estimate) {
    const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity(), R = pose.linear();
    const auto equations = equationsOf(matches, pose);
    const double noise = varianceFactor(equations.cost, matches.size());
    const Prior prior = known.times(noise);
    const auto turn = rotationFrom(equations, pose, prior);
    const auto move = translationInformation(matches, R);
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
    estimate.weakestAxis =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(move.information).eigenvectors().col(0);
    Sectors shown = Sectors::Zero();
    for (const auto& match : matches)
        shown[sectorOf(match.point)] +=
            match.weight * std::pow(match.normal.dot(estimate.weakestAxis), 2);
    estimate.weakestSpread = spreadOf(shown);
    // Normals are known from no more independent points than residuals are; and where an edge was
    // taken for a plane, worse.
    constexpr double kEdges = 3;
    const Eigen::Matrix3d priorHere = prior.translation * identity,
                          alone = move.information + kPriorShare * priorHere,
                          clear = move.information -
                                  kEdges / plane_tuning::kIndependentRatio * move.pretended;
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

namespace {
/** `pose`: where the iteration begins, and gets where it ends. */
PlaneEstimate registered(const FindMatches& find, const Prior& prior, double kernel,
                         const PlaneRegistrationOptions& options, Eigen::Isometry3d& pose) {
    Iterate now{pose, {}};
    bool converged = false;
    for (double width = std::max(kernel, options.last_kernel);;
         width = std::max(width / 2, options.last_kernel)) {
        converged = iterate(find, prior, width, options, now);
        if (width <= options.last_kernel) break;
    }
    pose = now.pose;
    if (now.matches.size() < options.min_matches) return predictedEstimate(prior.pose, options);
    PlaneEstimate estimate;
    settle(now.matches, now.pose, prior, estimate);
    estimate.rotation.iterations = now.iterations;
    estimate.rotation.converged = converged;
    return estimate;
}
}  // namespace

PlaneEstimate registerByMatches(const FindMatches& find, const Prior& prior, double kernel,
                                const PlaneRegistrationOptions& options) {
    Eigen::Isometry3d pose = prior.pose;
    return registered(find, prior, kernel, options, pose);
}

PlaneEstimate registerToPlanes(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                               const Prior& prior, double kernel,
                               const PlaneRegistrationOptions& options) {
    return registerToPlanes(map, points, prior, prior.pose, kernel, options);
}

PlaneEstimate registerToPlanes(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                               const Prior& prior, const Eigen::Isometry3d& start, double kernel,
                               const PlaneRegistrationOptions& options) {
    Matcher matcher(map, points, plane_tuning::kPointSigma_m);
    Eigen::Isometry3d pose = start;
    auto estimate =
        registered([&](const Eigen::Isometry3d& at, double width) { return matcher.at(at, width); },
                   prior, kernel, options, pose);
    if (estimate.valid) estimate.inlierRatio = matcher.shareAt(pose, options.last_kernel);
    return estimate;
}
}  // namespace delio::odometry
