#include "odometry/dynamic_objects.h"

#include <gtest/gtest.h>

#include "core/voxel_grid.h"
#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using odometry::DynamicObjects;
using test::poseAt;

/** A street of houses and parked cars along x, without an end that matters. */
test::Scene street() {
    test::Scene scene = {{{-200, -50, -3}, {500, 50, -1.8}}};
    for (int i = -10; i < 40; ++i) {
        const double x = 12 * i + 3 * (i % 3);
        scene.push_back({{x, 9, -1.8}, {x + 8, 20, 4.0 + i % 4}});
        scene.push_back({{x + 4, -22, -1.8}, {x + 11, -10, 5}});
        if (i % 2) scene.push_back({{x, -7, -1.8}, {x + 4, -5.2, -0.3}});
    }
    return scene;
}

test::Block van(double x, double y) { return {{x, y - 1, -1.6}, {x + 5, y + 1, 0.2}}; }

bool isIn(const test::Block& block, const Eigen::Vector3d& point) {
    constexpr double kNear = 0.15;
    return ((point - block.low).array() > -kNear).all() &&
           ((point - block.high).array() < kNear).all();
}

/** How much of a moving block was told, and how much else, in a drive along x. */
class MovingObjectsInAStreet : public testing::Test {
 protected:
    /** One scan more, `step_s` after the one before. `things`: in the world. `predicted`: where
     *  the motion model has the sensor, of which detect() is asked; remembered is the true pose. */
    void look(const Eigen::Isometry3d& pose, const test::Scene& things,
              const Eigen::Isometry3d& predicted, double step_s = 0.1) {
        test::Scene scene = street();
        scene.insert(scene.end(), things.begin(), things.end());
        const auto all = ringScan(scene, pose * tilt_, {48, 900, -24, 4, 0.02}, noise_).points;
        const auto points = voxelCentroids(all, 0.25);
        stamp_s_ += step_s;
        const auto told = objects_.detect(
            objects_.see(points, objects_.freeSpaceOf(all), tilt_.linear().cast<float>()),
            predicted, stamp_s_);
        objects_.remember(pose);
        found_ = missed_ = wrong_ = 0;
        for (Eigen::Index i = 0; i < points.cols(); ++i) {
            const Eigen::Vector3d point = pose * tilt_ * points.col(i).cast<double>();
            const bool moves = std::any_of(things.begin(), things.end(),
                                           [&](const auto& thing) { return isIn(thing, point); });
            const bool wasTold = told[static_cast<std::size_t>(i)] != 0;
            found_ += moves && wasTold;
            missed_ += moves && !wasTold && point.z() > -1.4;  // lower is ground
            wrong_ += !moves && wasTold;
        }
    }

    /** The same with a prediction that is right. */
    void look(const Eigen::Isometry3d& pose, const test::Scene& things, double step_s = 0.1) {
        look(pose, things, pose, step_s);
    }

    /** So many scans behind a van that stays `gap_m` ahead. Counts what the scans from the sixth on
     *  found. */
    void follow(double gap_m, int scans) {
        int found = 0, missed = 0, wrong = 0;
        for (int i = 0; i < scans; ++i) {
            look(poseAt(0.9 * i, 0, 0), {van(0.9 * i + gap_m, 0)});
            if (i < 5) continue;
            found += found_;
            missed += missed_;
            wrong += wrong_;
        }
        found_ = found;
        missed_ = missed;
        wrong_ = wrong;
    }

    test::Noise noise_;
    Eigen::Isometry3d tilt_ = Eigen::Isometry3d::Identity();  //!< of the sensor
    DynamicObjects objects_{DynamicObjectsOptions()};
    double stamp_s_ = 0;
    int found_ = 0, missed_ = 0, wrong_ = 0;
};

TEST_F(MovingObjectsInAStreet, AVanThatStaysFiveMetresAheadForAHundredScans) {
    follow(5, 100);
    EXPECT_GT(found_, 90 * 100);
    EXPECT_LT(missed_, 0.1 * found_);
    EXPECT_LT(wrong_, 0.02 * found_);
}

TEST_F(MovingObjectsInAStreet, AVanAheadIsFoundByATiltedSensor) {
    tilt_ = poseAt(0, 0, 0, 0, -0.1, 0.1);
    follow(8, 40);
    EXPECT_GT(found_, 35 * 60);
    EXPECT_LT(missed_, 0.1 * found_);
    EXPECT_LT(wrong_, 0.02 * found_);
}

TEST_F(MovingObjectsInAStreet, OncomingAndCrossingOnesAreToldWithinThreeScans) {
    for (int i = 0; i < 8; ++i) {
        const double ahead = 0.5 * i;
        look(poseAt(ahead, 0, 0, 0.002 * i, 0, 0), {van(25 - 1.2 * i, 3), van(8, -4 + 0.7 * i)});
        if (i < 3) continue;
        EXPECT_GT(found_, 100) << i;
        EXPECT_LT(missed_, 0.2 * found_) << i;
        EXPECT_LT(wrong_, 0.05 * found_) << i;
    }
}

/** What a motion model may be off by in scan `i`, half of the margin (0.4 m): another way in each.
 */
Eigen::Isometry3d off(int i) {
    const double to = i % 2 ? -0.2 : 0.2;
    return i / 2 % 3 == 0 ? poseAt(to, 0, 0) : i / 2 % 3 == 1 ? poseAt(0, to, 0) : poseAt(0, 0, to);
}

// detect() is asked at the predicted pose, "good to a part of the margin".
TEST_F(MovingObjectsInAStreet, APredictionThatIsOffByHalfTheMarginWillDo) {
    int found = 0, missed = 0, wrong = 0;
    for (int i = 0; i < 24; ++i) {
        const Eigen::Isometry3d pose = poseAt(0.5 * i, 0, 0, 0.002 * i);
        look(pose, {van(32 - 1.2 * i, 3), van(0.5 * i + 8, -2)}, pose * off(i));
        if (i < 8) continue;
        EXPECT_GT(found_, 150) << i;
        found += found_;
        missed += missed_;
        wrong += wrong_;
    }
    EXPECT_LT(missed, 0.1 * found);
    EXPECT_LT(wrong, 0.05 * found);
}

TEST_F(MovingObjectsInAStreet, APredictionThatIsOffMakesNothingMove) {
    for (int i = 0; i < 20; ++i) {
        const Eigen::Isometry3d pose = poseAt(0.9 * i, 0.05 * i, 0, 0.01 * i);
        look(pose, {}, pose * off(i));
        EXPECT_LT(wrong_, 100) << i;  // of thousands
    }
}

TEST_F(MovingObjectsInAStreet, WhereNothingMovesNothingIsTold) {
    for (int i = 0; i < 20; ++i) {
        look(poseAt(0.9 * i, 0.05 * i, 0, 0.01 * i, 0, 0), {});
        EXPECT_LT(wrong_, 20) << i;
    }
    for (int i = 0; i < 3; ++i) {  // the vehicle stands
        look(poseAt(17.1, 0.95, 0, 0.19, 0, 0), {});
        EXPECT_LT(wrong_, 20) << i;
    }
}

TEST_F(MovingObjectsInAStreet, AVanThatHasStoppedIsPartOfTheStreetAgain) {
    for (int i = 0; i < 6; ++i) look(poseAt(0.5 * i, 0, 0), {van(20 - i, 3)});
    EXPECT_GT(found_, 100);
    for (int i = 0; i < 12; ++i) look(poseAt(3, 0, 0), {van(14, 3)});
    EXPECT_EQ(found_, 0);
}

TEST_F(MovingObjectsInAStreet, NothingIsToldByTheFirstScanOrAfterAPause) {
    look(Eigen::Isometry3d::Identity(), {van(20, 3)});
    EXPECT_EQ(found_ + wrong_, 0);
    look(Eigen::Isometry3d::Identity(), {van(19, 3)});
    look(Eigen::Isometry3d::Identity(), {van(12, 3)}, 30);
    EXPECT_EQ(found_ + wrong_, 0);
}

// It hides its way, so that it is told only by the places that it left: these were taken for a part
// of the street.
TEST_F(MovingObjectsInAStreet, PlacesThatWereTakenForThoseOfSomethingStandingAreUnmaskedOnce) {
    Eigen::Index unmasked = 0;
    int outside = 0;
    for (int i = 0; i < 8; ++i) {
        look(poseAt(0.9 * i, 0, 0), {van(0.9 * i + 5, 0)});
        const auto& places = objects_.unmasked();
        unmasked += places.cols();
        if (i > 5) {
            EXPECT_EQ(places.cols(), 0) << i;
        }
        const test::Block way{{5, -1, -1.6}, {5 + 0.9 * i + 5, 1, 0.2}};
        for (Eigen::Index k = 0; k < places.cols(); ++k)
            outside += !isIn(way, places.col(k).cast<double>());
    }
    EXPECT_GT(unmasked, 100);
    EXPECT_EQ(outside, 0);
}

using odometry::Segment;

Eigen::Matrix3Xf seen(const test::Scene& things,
                      const Eigen::Isometry3d& pose = Eigen::Isometry3d::Identity()) {
    test::Noise noise;
    test::Scene scene = {{{-200, -200, -3}, {200, 200, -1.8}}};
    scene.insert(scene.end(), things.begin(), things.end());
    return ringScan(scene, pose, {64, 1800, -24, 8, 0.02}, noise).points;
}

TEST(Segments, ThingsThatStandApartAreOneSegmentEach) {
    const auto segments = segmentsOf(
        seen({{{6, -1, -1.8}, {10, 1, 0.5}}, {{6, 3, -1.8}, {10, 5, 0.5}}}), SegmentTuning{});
    ASSERT_EQ(segments.size(), 2U);
    for (const Segment& segment : segments) {
        EXPECT_GT(segment.points.size(), 200U);
        EXPECT_NEAR(segment.box.min().x(), 6, 0.15);
        EXPECT_NEAR(segment.box.max().z(), 0.5, 0.15);
        EXPECT_GT(segment.box.min().z(), -1.8 + 0.2);  // without the ground
        EXPECT_NEAR(segment.box.sizes().y(), 2, 0.2);
    }
}

TEST(Segments, GroundIsNoneAlsoWhereItSlopes) {
    EXPECT_TRUE(segmentsOf(seen({}), SegmentTuning{}).empty());
    const Eigen::Isometry3d tilted = test::poseAtDeg(0, 0, 0, 0, 5);
    EXPECT_TRUE(segmentsOf(seen({}, tilted), SegmentTuning{}).empty());
}

TEST(Segments, WhatIsLongHighFarOrNearlyUnseenIsLeftOut) {
    EXPECT_TRUE(segmentsOf(seen({{{-10, 5, -1.8}, {10, 6, 0.5}}}), SegmentTuning{}).empty());
    const test::Block box{{12, -1, -1.8}, {14, 1, -0.2}};
    EXPECT_EQ(segmentsOf(seen({box}), SegmentTuning{}).size(), 1U);
    SegmentTuning options;
    options.radius = 10;
    EXPECT_TRUE(segmentsOf(seen({box}), options).empty());
    options = {};
    options.min_points = 100000;
    EXPECT_TRUE(segmentsOf(seen({box}), options).empty());
    // Of a sign over the road only what is low enough.
    EXPECT_TRUE(segmentsOf(seen({{{12, -1, 1.3}, {12.2, 1, 1.6}}}), SegmentTuning{}).empty());
}

TEST(Segments, NoPointsNoSegments) {
    EXPECT_TRUE(segmentsOf(Eigen::Matrix3Xf(3, 0), SegmentTuning{}).empty());
}
}  // namespace
