#include "odometry/dynamic_objects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using odometry::Outlines;

TEST(Outlines, ThoseAboutAPlaceAreFoundByTheirX) {
    Outlines outlines;
    for (int i = 0; i < 10; ++i)
        outlines.add({static_cast<float>(i), static_cast<float>(-i), 1}, {4, 2, 1.5F});
    const std::pair<std::size_t, std::size_t> middle(3, 6), none(10, 10);
    EXPECT_EQ(outlines.about(4, 1), middle);  // both ends are within reach
    EXPECT_EQ(outlines.about(20, 1), none);
    EXPECT_EQ(Outlines().about(0, 1).second, 0U);
    EXPECT_EQ(outlines.place(7), Eigen::Vector3f(7, -7, 1));
    EXPECT_EQ(outlines.sizeOf(7), Eigen::Vector3f(4, 2, 1.5F));
}

TEST(Outlines, AllAtOnceAreAsAlikeAsOneByOne) {
    test::Noise noise;
    Outlines outlines;
    std::vector<Eigen::Vector3f> sizes;
    for (int i = 0; i < 1000; ++i) {
        sizes.push_back((Eigen::Vector3d(3, 2, 2) + noise.normals()).cast<float>());
        outlines.add(Eigen::Vector3f(static_cast<float>(i), 0, 0), sizes.back());
    }
    const Eigen::Vector3f asked(3, 2, 2);
    std::vector<std::size_t> found, expected;
    outlines.findAlike({100, 900}, asked, found);
    for (std::size_t i = 100; i < 900; ++i)
        if (odometry::alike(sizes[i], asked)) expected.push_back(i);
    EXPECT_EQ(found, expected);
    EXPECT_GT(found.size(), 100U);
    EXPECT_LT(found.size(), 700U);
}
}  // namespace
