#include "mount.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {
using namespace delio::synth;
using Eigen::Vector3d;

ScanPoints onePoint(float x, float y, float z) {
    ScanPoints points;
    points.xyzi = {x, y, z, 0.5F};
    points.ring = {7};
    return points;
}

Vector3d placeOf(const ScanPoints& points) {
    return Eigen::Map<const Eigen::Vector3f>(points.xyzi.data()).cast<double>();
}

TEST(SynthMount, PitchedItsNoseGoesDown) {
    const Vector3d nose = Mount{0, 25, 0}.pose() * Vector3d::UnitX();
    EXPECT_NEAR(nose.z(), -std::sin(25 * M_PI / 180), 1e-12);
    EXPECT_NEAR(nose.x(), std::cos(25 * M_PI / 180), 1e-12);
}

TEST(SynthMount, RolledWhatWasAboveIsToTheLeft) {
    auto points = onePoint(1, 2, 3);
    Mount{90, 0, 0}.turn(points);
    EXPECT_TRUE(placeOf(points).isApprox(Vector3d(1, 3, -2), 1e-6)) << placeOf(points);
    EXPECT_EQ(points.xyzi[3], 0.5F);
}

TEST(SynthMount, YawIsAppliedFirstThenPitchThenRoll) {
    const Mount mount{10, 20, 30};
    const Eigen::Matrix3d R = Mount{0, 0, 30}.pose().linear() * Mount{0, 20, 0}.pose().linear() *
                              Mount{10}.pose().linear();
    EXPECT_TRUE(mount.pose().linear().isApprox(R, 1e-12));
    auto points = onePoint(4, 5, 6);
    mount.turn(points);
    EXPECT_TRUE((mount.pose() * placeOf(points)).isApprox(Vector3d(4, 5, 6), 1e-6));
}

TEST(SynthMount, UprightNotABitChanges) {
    auto points = onePoint(-0.0F, 0.1F, 1e-30F);
    const auto before = points.xyzi;
    Mount().turn(points);
    EXPECT_TRUE(std::signbit(points.xyzi[0]));
    EXPECT_EQ(points.xyzi, before);
}

TEST(SynthMount, IsReadFromThreeNumbers) {
    const auto mount = mountIn("-90,2.5,0");
    ASSERT_TRUE(mount);
    EXPECT_EQ(mount->roll_deg, -90);
    EXPECT_EQ(mount->pitch_deg, 2.5);
    EXPECT_TRUE(mountIn("0,0,0")->isUpright());
    for (const char* text : {"", "1", "1,2", "1,2,3,4", "1,2,x", "1,,3", "1,2,3,", "1, 2,3",
                             "1,2,nan", "1,2,inf", "upright"})
        EXPECT_FALSE(mountIn(text)) << text;
}
}  // namespace
