#include "map/visibility_votes.h"

#include <gtest/gtest.h>

namespace {
using namespace delio;

/** Where a first point lies in its voxel is kept in 1/256; just below a border it rounds to all of
 *  them, which is one too many for a byte. */
TEST(VisibilityVotes, APointJustBelowABorderOfItsVoxelStaysThere) {
    map::RemovalOptions options;
    options.voxelSize_m = 4;
    map::VisibilityVotes votes(options);
    const Eigen::Vector3d point(-1e-17, 10, 0.1);
    votes.hit(point, false, 0);
    // A wall 20 m ahead, of which only a part is seen: what stands 10 m ahead was looked through,
    // what stands 4 m beside was not.
    Eigen::Matrix3Xf wall(3, 81 * 81);
    for (Eigen::Index i = 0; i < wall.cols(); ++i)
        wall.col(i) = Eigen::Vector3f(0.05F * static_cast<float>(i % 81 - 40), 20,
                                      0.05F * static_cast<float>(i / 81 - 40));
    for (int k = 0; k < 4; ++k)
        votes.look(odometry::RangeImage(wall, options.cell_deg), Eigen::Isometry3d::Identity(), 60);
    votes.decide();
    EXPECT_TRUE(votes.isDynamic(point));
}
}  // namespace
