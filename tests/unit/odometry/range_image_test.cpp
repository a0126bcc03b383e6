#include "odometry/range_image.h"

#include <gtest/gtest.h>

#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using odometry::Place;
using odometry::RangeImage;

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

TEST_F(RangeImageOfARoom, PutAsideAndTakenBackItSaysTheSameButBetweenRings) {
    const RangeImage again(image_.packed(), 0.5);
    test::Noise noise;
    int free = 0, taken = 0;
    for (int i = 0; i < 20000; ++i) {
        const Eigen::Vector3f p = (12 * noise.direction() * noise.uniform()).cast<float>();
        const Place before = image_.at(p, 0.4F), after = again.at(p, 0.4F);
        // Ranges are rounded: what is near the margin may be told otherwise.
        if (before == Place::kFree && image_.at(p, 0.41F) == Place::kFree) {
            EXPECT_NE(after, Place::kTaken);
            ++free;
        }
        if (before == Place::kTaken && image_.at(p, 0.39F) == Place::kTaken) {
            EXPECT_EQ(after, Place::kTaken);
            ++taken;
        }
    }
    EXPECT_GT(free, 500);
    EXPECT_GT(taken, 50);
    EXPECT_NEAR(again.ringSpacing(), 0.5 * M_PI / 180, 0.3 * M_PI / 180);
}

TEST(RangeImage, BetweenTwoRingsFarApartOnlyWhatBothWentByIsFree) {
    // Two rings of 2 degrees apart: the upper one sees a wall at 20 m, the lower one the ground at
    // 8 m.
    Eigen::Matrix3Xf points(3, 720);
    for (int i = 0; i < 360; ++i) {
        const auto beam = [&](double elevation_deg, double range) -> Eigen::Vector3f {
            const double az = i * M_PI / 180 / 2, el = elevation_deg * M_PI / 180;
            return (range * Eigen::Vector3d(std::cos(el) * std::cos(az),
                                            std::cos(el) * std::sin(az), std::sin(el)))
                .cast<float>();
        };
        points.col(2 * i) = beam(-9.9, 8);
        points.col(2 * i + 1) = beam(-7.9, 20);
    }
    const RangeImage direct(points, 0.5), filled(direct.packed(), 0.5);
    const auto at = [&](double range) -> Eigen::Vector3f {
        const double az = 1, el = -8.3 * M_PI / 180;
        return (range * Eigen::Vector3d(std::cos(el) * std::cos(az), std::cos(el) * std::sin(az),
                                        std::sin(el)))
            .cast<float>();
    };
    EXPECT_EQ(filled.at(at(12), 0.4F), Place::kUnknown);
    EXPECT_EQ(direct.at(at(12), 0.4F), Place::kFree);
    EXPECT_EQ(filled.at(at(6), 0.4F), Place::kFree);
    EXPECT_NEAR(filled.ringSpacing(), 2 * M_PI / 180, 0.6 * M_PI / 180);
}
}  // namespace
