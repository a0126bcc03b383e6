#include "delio/odometry/placement.h"

#include "delio/odometry/relocalisation.h"
#include "delio/scan/voxel_grid.h"
#include "delio/surfaces/surfaces.h"

namespace delio {
using points::PointEstimate;

namespace {
/** Where the prediction is off by metres: found by surfaces, then placed by points. */
PointEstimate relocalised(const ScanToMap& map, const ScanView& view, const Expectation& expected,
                          const PlaneOdometryOptions& options) {
    const auto surfacesOf = [&](const Eigen::Matrix3Xf& points) {
        return surfaces::surfacesOf(points, options.normals, options.bilateral);
    };
    const auto& registration = options.registration;
    const Eigen::Matrix3Xd thinned =
        scan::voxelCentroids(view.fine, options.tracker.scan_spacing).cast<double>();
    const auto found = relocalise(map.planes(), surfacesOf(expected.reference.points),
                                  expected.reference.pose, thinned, surfacesOf(view.points),
                                  expected.pose, expected.reach_m, registration, options.pattern);
    return map.place(view.coarse, found.pose(), registration.search_step);
}

/** The better of what was found. */
class Best {
 public:
    void consider(const PointEstimate& other) {
        if (other.valid && (!estimate.valid || other.share > estimate.share)) estimate = other;
    }
    bool has(double share) const { return estimate.valid && estimate.share >= share; }

    PointEstimate estimate;
};
}  // namespace

Placement placeScan(const ScanToMap& map, const ScanView& view, const Expectation& expected,
                    const PlaneOdometryOptions& options) {
    const auto& points = view.coarse;
    constexpr double kUsual = 0.75, kUsualAtFirst = 0.25;
    const double usual = expected.usualShare, likely = usual > 0 ? kUsual * usual : kUsualAtFirst;
    // A prediction that is off by more than any kernel (a hand's swings) is no start.
    const bool isTurned = expected.isShaken && !expected.isGuess;
    Best best{expected.isGuess
                  ? map.placeAnywhere(points, expected.pose, expected.start_m, expected.upright)
              : isTurned ? map.placeTurned(points, expected.pose, likely)
                         : map.place(points, expected.pose, expected.kernel_m)};
    const bool isTurnedIfShaken = isTurned || !expected.isShaken;
    if (points.cols() == 0 || (best.has(likely) && isTurnedIfShaken))
        return {best.estimate, expected.isGuess || isTurned};
    if (!isTurned) best.consider(map.placeTurned(points, expected.pose, likely));
    if (!expected.isGuess && !best.has(likely))  // of a guess that was a start already
        best.consider(map.place(points, expected.pose, options.points.first_kernel));
    // After an interruption it may be anywhere: another place, which shares the ground with the
    // map's, must not be taken for it.
    constexpr double kSomewhere = 0.35;
    const double enough = (expected.motionIsKnown ? options.tracker.lost_share : kUsual) * usual;
    if (best.has(enough)) return {best.estimate, true};
    best.consider(relocalised(map, view, expected, options));
    best.estimate.valid = best.has(expected.motionIsKnown ? kSomewhere * usual : enough);
    return {best.estimate, true};
}
}  // namespace delio
