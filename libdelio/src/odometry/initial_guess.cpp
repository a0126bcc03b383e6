#include "odometry/initial_guess.h"

#include <tbb/parallel_for.h>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/voxel_grid.h"
#include "paper/normals.h"

namespace delio::odometry {
double agreement(const PlaneMap& map, const paper::SurfaceNormals& surfaces,
                 const Eigen::Isometry3d& pose, double kernel) {
    const Eigen::Matrix3d R = pose.linear();
    const Eigen::Vector3d t = pose.translation();
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
                             const paper::SurfaceNormals& surfaces, const Eigen::Isometry3d& centre,
                             double radius, const PlaneRegistrationOptions& options) {
    const Eigen::Matrix3d R = centre.linear();
    constexpr std::size_t kBest = 12;
    // A part shows which starts are good, and where they lead to.
    constexpr Eigen::Index kEnough = 1000;
    const Eigen::Matrix3Xd part = sample(points, kEnough);
    paper::SurfaceNormals few;
    few.points = sample(surfaces.points, kEnough);
    few.directions = sample(surfaces.directions, kEnough);
    const int steps = static_cast<int>(radius / options.search_step);
    std::vector<std::pair<double, Eigen::Vector3d>> starts;
    for (int x = -steps; x <= steps; ++x)
        for (int y = -steps; y <= steps; ++y) {
            const Eigen::Vector3d offset(x * options.search_step, y * options.search_step, 0);
            if (offset.norm() <= radius) starts.emplace_back(0, centre.translation() + offset);
        }
    tbb::parallel_for(std::size_t{0}, starts.size(), [&](std::size_t i) {
        starts[i].first =
            agreement(map, few, isometry(R, starts[i].second), options.search_step / 2);
    });
    std::stable_sort(starts.begin(), starts.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    if (starts.size() > kBest) starts.resize(kBest);
    starts.emplace_back(0, centre.translation());
    PlaneEstimate best;
    double bestAgreement = -1;
    for (const auto& [rough, t] : starts) {
        const auto found = registerToPlanes(map, part, priorOf(isometry(R, t), options),
                                            options.search_step, options);
        const double agreed = agreement(map, surfaces, found.pose(), 2 * options.last_kernel);
        if (agreed <= bestAgreement) continue;
        best = found;
        bestAgreement = agreed;
    }
    return best;
}

PlaneEstimate relocalise(const PlaneMap& map, const paper::SurfaceNormals& reference,
                         const Eigen::Isometry3d& referencePose, const Eigen::Matrix3Xd& points,
                         const paper::SurfaceNormals& surfaces, const Eigen::Isometry3d& guess,
                         double radius, const PlaneRegistrationOptions& options,
                         const PatternRegistrationOptions& pattern) {
    const Eigen::Matrix3d R = referencePose.linear();
    const auto turned =
        paper::registerPatterns(paper::patternOf(reference), paper::patternOf(surfaces),
                                R.transpose() * guess.linear(), pattern);
    return searchInPlanes(map, points, surfaces, isometry(R * turned.rotation, guess.translation()),
                          radius, options);
}

namespace {
/** Where the prediction is off by metres: found by surfaces, then placed by points. */
PointEstimate relocalised(const LocalMap& map, const ScanView& view, const Expectation& expected,
                          const ScaledOptions& options) {
    const auto surfacesOf = [&](const Eigen::Matrix3Xf& points) {
        return paper::surfacesOf(points, NormalsOptions(), BilateralFilterOptions());
    };
    const auto& registration = options.registration;
    const Eigen::Matrix3Xd thinned =
        voxelCentroids(view.fine, options.spacing.scan_spacing).cast<double>();
    const auto found =
        relocalise(map.planes(), surfacesOf(expected.reference.points), expected.reference.pose,
                   thinned, surfacesOf(view.points), expected.pose, expected.reach_m, registration,
                   PatternRegistrationOptions());
    return map.place(view.coarse, found.pose(), registration.search_step);
}

/** The better of what was found. */
class Best {
 public:
    void consider(const PointEstimate& other) {
        if (other.valid && (!estimate.valid || other.inlierRatio > estimate.inlierRatio))
            estimate = other;
    }
    bool has(double share) const { return estimate.valid && estimate.inlierRatio >= share; }

    PointEstimate estimate;
};

/** Where the pose is a guess. */
Placement searchScan(const LocalMap& map, const ScanView& view, const Expectation& expected,
                     const ScaledOptions& options) {
    const auto& points = view.coarse;
    const double usual = expected.usualInlierRatio, likely = expected.likelyInlierRatio();
    Best best{map.placeAnywhere(points, expected.pose, expected.start, expected.upright)};
    if (points.cols() == 0 || (best.has(likely) && !expected.isShaken))
        return {best.estimate, true};
    if (!expected.isUrgent || expected.isShaken)
        best.consider(map.placeTurned(points, expected.pose, likely));
    if (expected.motionIsKnown && !expected.isUrgent && !best.has(likely)) {
        const Eigen::Isometry3d& latest = expected.reference.pose;
        best.consider(map.placeOnward(points, latest, latest.inverse() * expected.pose));
    }
    // After an interruption it may be anywhere: another place, which shares the ground with the
    // map's, must not be taken for it.
    constexpr double kSomewhere = 0.35;
    const double enough =
        (expected.motionIsKnown ? options.tracker.lost_share : Expectation::kLikely) * usual;
    if (best.has(enough)) return {best.estimate, true};
    if (!expected.isUrgent) best.consider(relocalised(map, view, expected, options));
    best.estimate.valid = best.has(expected.motionIsKnown ? kSomewhere * usual : enough);
    return {best.estimate, true};
}
}  // namespace

Placement placeScan(const LocalMap& map, const ScanView& view, const Expectation& expected,
                    const ScaledOptions& options) {
    if (expected.isGuess) return searchScan(map, view, expected, options);
    // A prediction that is off by more than any kernel (a hand's swings) is no start.
    if (expected.isShaken)
        return {map.placeTurned(view.coarse, expected.pose, expected.likelyInlierRatio()), true};
    return {map.place(view.coarse, expected.pose, expected.kernel_m), false};
}
}  // namespace delio::odometry
