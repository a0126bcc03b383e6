#include "core/voxel_grid.h"

#include <gtest/gtest.h>

namespace delio::odometry {
namespace {
Eigen::Matrix3Xd counted(Eigen::Index count) {
    Eigen::Matrix3Xd points(3, count);
    for (Eigen::Index i = 0; i < count; ++i) points.col(i).setConstant(static_cast<double>(i));
    return points;
}

TEST(Sample, TakesAFewEvenlyOverTheOrder) {
    const auto few = sample(counted(10), 4);
    ASSERT_EQ(few.cols(), 4);
    EXPECT_EQ(few.row(0), Eigen::RowVector4d(0, 3, 6, 9));
    EXPECT_EQ(sample(counted(9), 4).cols(), 3);
}

TEST(Sample, TakesAllWhereThereAreFew) {
    EXPECT_EQ(sample(counted(4), 4), counted(4));
    EXPECT_EQ(sample(counted(0), 4).cols(), 0);
}
}  // namespace
}  // namespace delio::odometry
