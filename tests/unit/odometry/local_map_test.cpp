#include "odometry/local_map.h"

#include <gtest/gtest.h>

#include "core/voxel_grid.h"
#include "delio/core/odometry_options.h"
#include "poses.h"
#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using test::metresBetween;
using test::poseAt;

/** A map of the yard as two scans saw it, and a scan of which the true pose is `there`. */
class AScanInAYard : public testing::Test {
 protected:
    AScanInAYard() {
        test::Noise noise;
        const auto fineAt = [&](const Eigen::Isometry3d& pose) -> Eigen::Matrix3Xf {
            return voxelCentroids(
                test::ringScan(test::yard(), pose, {48, 900, -24, 8, 0.01}, noise).points,
                options.spacing.map_spacing);
        };
        for (const double x : {0.0, 1.0}) map.add(fineAt(poseAt(x, 0, 0)), poseAt(x, 0, 0));
        view.fine = fineAt(there);
        view.coarse = firstOfVoxels(view.fine, options.spacing.point_spacing).cast<double>();
        view.thinned = voxelCentroids(view.fine, options.spacing.scan_spacing).cast<double>();
    }

    /** As points would have placed it, of which `share` fitted. */
    Eigen::Isometry3d refined(const Eigen::Isometry3d& placedAt, double share) const {
        odometry::PointEstimate placed;
        placed.pose = placedAt;
        placed.inlierRatio = share;
        placed.matches = 500;
        placed.residual_m = 0.1;
        placed.valid = true;
        return map.registerPlanes(view, placed, placedAt, Motion::kFast).pose();
    }

    ScaledOptions options;
    LocalMap map{options.localMap, options.map, options.registration, options.pointMap,
                 options.points};
    ScanView view;
    const Eigen::Isometry3d there = poseAt(2, 0.1, 0);
};

TEST_F(AScanInAYard, IsRefinedByPlanes) {
    const auto placed = map.place(view.coarse, there * poseAt(0.2, 0.2, 0), 1);
    ASSERT_TRUE(placed.valid);
    EXPECT_LT(
        metresBetween(map.registerPlanes(view, placed, placed.pose, Motion::kFast).pose(), there),
        0.01);
}

// Farther than planes are believed, but there more points fit than where they were placed.
TEST_F(AScanInAYard, IsTakenFromWherePointsPlacedItWrongly) {
    EXPECT_LT(metresBetween(refined(there * poseAt(0.15, 0.15, 0), 0.3), there), 0.01);
}

TEST_F(AScanInAYard, StaysWherePointsFitBetterThanWherePlanesLead) {
    const auto placed = there * poseAt(0.15, 0.15, 0);
    EXPECT_LT(metresBetween(refined(placed, 1), placed), 1e-9);
}
}  // namespace
