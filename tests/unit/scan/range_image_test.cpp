#include "delio/scan/range_image.h"

#include <gtest/gtest.h>

#include "ring_scan.h"

namespace {
using namespace delio;
using scan::Place;
using scan::RangeImage;

class RangeImageOfARoom : public testing::Test {
 protected:
    RangeImageOfARoom() {
        test::Noise noise;
        const test::Sensor sensor{64, 1800, -24, 8, 0.02};
        image_ = RangeImage(
            ringScan(test::room(), Eigen::Isometry3d::Identity(), sensor, noise).points, 0.5);
    }
    Place at(float x, float y, float z) const { return image_.at({x, y, z}, 0.4F); }

    RangeImage image_;
};

TEST_F(RangeImageOfARoom, WhatBeamsWentThroughIsFree) {
    EXPECT_EQ(at(9, -2, 0), Place::kFree);  // before the wall at x = 12
    EXPECT_EQ(at(-7, 0.1F, 0), Place::kFree);
    EXPECT_EQ(at(-7, -0.001F, 0), Place::kFree);  // across the seam of the azimuth
}

TEST_F(RangeImageOfARoom, WhereBeamsEndedIsTaken) {
    EXPECT_EQ(at(11.8F, -2, 0), Place::kTaken);
    EXPECT_EQ(at(12.3F, -2, 0), Place::kTaken);   // within the margin
    EXPECT_EQ(at(5.1F, 4.5F, 0), Place::kTaken);  // a cupboard
}

TEST_F(RangeImageOfARoom, BehindWhatIsSeenAndOutOfViewNothingIsKnown) {
    EXPECT_EQ(at(14, -2, 0), Place::kUnknown);
    EXPECT_EQ(at(8, 6.5F, 0), Place::kUnknown);  // behind the cupboard
    EXPECT_EQ(at(0.5F, 0, 3), Place::kUnknown);  // above all rings
    EXPECT_EQ(RangeImage().at({3, 0, 0}, 0.4F), Place::kUnknown);
}
}  // namespace
