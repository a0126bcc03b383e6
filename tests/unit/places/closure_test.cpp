#include "places/closure.h"

#include <gtest/gtest.h>

#include <vector>

#include "poses.h"
#include "town.h"

namespace {
using namespace delio;
using namespace delio::places_test;
using places::RegistrableSubmap;
using test::poseAt;
using test::poseAtDeg;

/** A submap of three scans along x from `start` on. */
places::Submap seenFrom(const test::Scene& scene, const Eigen::Isometry3d& start) {
    Poses poses{start};
    for (int i = 0; i < 4; ++i) poses.push_back(poses.back() * poseAt(3, 0, 0));
    return submapsOf(scene, poses, poses).at(0);
}

places::Closure closed(const places::Submap& from, const places::Submap& to,
                       const Eigen::Isometry3d& guess) {
    const RegistrableSubmap fromMap(from.points), toMap(to.points);
    const places::ClosureEnd a{from, fromMap}, b{to, toMap};
    auto closure = closureOf(a, b, guess, {});
    if (closure.reason.empty()) confirm(closure, a, b, {});
    return closure;
}

/** The middle one of the poses is the key. */
Eigen::Isometry3d keyOf(const Eigen::Isometry3d& start) { return start * poseAt(6, 0, 0); }

class ClosureFrom : public testing::TestWithParam<double> {};

TEST_P(ClosureFrom, EitherDirectionIsRight) {
    const Eigen::Isometry3d a = poseAt(0, 0, 0), b = poseAtDeg(4, 0.7, 0, GetParam());
    const auto from = seenFrom(town(), a), to = seenFrom(town(), b);
    const Eigen::Isometry3d truth = keyOf(a).inverse() * keyOf(b);
    const auto closure = closed(from, to, truth * poseAtDeg(0.5, -0.4, 0.3, 1));
    ASSERT_EQ(closure.reason, "");
    EXPECT_LT(test::metresBetween(closure.increment.pose, truth), 0.02);
    EXPECT_LT(test::degreesBetween(closure.increment.pose, truth), 0.1);
    EXPECT_GT(closure.overlap, 0.4);
    EXPECT_EQ(closure.increment.covariance.llt().info(), Eigen::Success);
    EXPECT_LT(closure.increment.covariance.diagonal().head<3>().maxCoeff(), 0.01 * 0.01);
}

INSTANTIATE_TEST_SUITE_P(Directions, ClosureFrom, testing::Values(0, 12, 180));

TEST(Closure, OfOtherPlacesIsNone) {
    const auto from = seenFrom(town(), poseAt(0, 0, 0)),
               to = seenFrom(test::yard(), poseAt(-3, 1, 0));
    EXPECT_NE(closed(from, to, poseAt(0, 0, 0)).reason, "");
}

TEST(Closure, OfNothingIsNone) {
    const auto from = seenFrom(town(), poseAt(0, 0, 0));
    places::Submap nothing = from;
    nothing.points.resize(3, 0);
    EXPECT_EQ(closed(from, nothing, poseAt(0, 0, 0)).reason, "not registered");
    EXPECT_EQ(closed(nothing, from, poseAt(0, 0, 0)).reason, "not registered");
}

// Between two walls without an end nothing tells how far along them it is.
TEST(Closure, OfACorridorHoldsAcrossItOnly) {
    const auto from = seenFrom(test::corridor(), poseAt(0, 0, 0)),
               to = seenFrom(test::corridor(), poseAt(1, 0.3, 0));
    const auto closure = closed(from, to, poseAt(1, 0, 0));
    const Eigen::Vector3d sigma = closure.increment.covariance.diagonal().head<3>().cwiseSqrt();
    EXPECT_GT(sigma.x(), 5);
    EXPECT_LT(sigma.y(), 0.05);
    EXPECT_NEAR(closure.increment.pose.translation().y(), 0.3, 0.02);
}

using places::FreeSpace;
using places::HeightImage;

/** DenseSubmap of 20 m by 20 m, and across it a wall of 4 m. */
Eigen::Matrix3Xf withWallAt(float x) {
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 80; ++i) {
        const float y = 0.1F + 0.25F * static_cast<float>(i);
        for (int k = 0; k < 80; ++k)
            points.emplace_back(0.1F + 0.25F * static_cast<float>(k), y, 0.0F);
        for (int k = 0; k < 16; ++k)
            points.emplace_back(x, y, 0.1F + 0.25F * static_cast<float>(k));
    }
    Eigen::Matrix3Xf cloud(3, static_cast<Eigen::Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i)
        cloud.col(static_cast<Eigen::Index>(i)) = points[i];
    return cloud;
}

TEST(FreeSpace, IsBuiltOnByWallsThatStandElsewhere) {
    const auto points = withWallAt(5.2F);
    const HeightImage here(points), there(withWallAt(9.2F));
    const FreeSpace free(here, points);
    EXPECT_EQ(free.conflict(here, test::poseAt(0, 0, 0)), 0);
    EXPECT_EQ(free.conflict(there, test::poseAt(0, 0, 0)), 1);
    EXPECT_EQ(free.conflict(there, test::poseAt(-4, 0, 0)), 0);
    EXPECT_EQ(free.conflict(there, test::poseAt(100, 0, 0)), 0);  // nothing to compare
}

// The rays of a scan pass where the wall would be, end at it, or end before it.
TEST(RegistrableSubmap, IsSeenThroughWhereAScanLooksFarther) {
    const Eigen::Isometry3d fromSensor = poseAt(2, 10, 1.5);
    const auto viewOf = [&](float wall) {
        return odometry::RangeImage(fromSensor.inverse().cast<float>() * withWallAt(wall), 2);
    };
    const RegistrableSubmap map(withWallAt(9.2F));
    EXPECT_GT(map.seenThrough(viewOf(14.2F), fromSensor), 0.8);
    EXPECT_EQ(map.seenThrough(viewOf(9.2F), fromSensor), 0);
    EXPECT_EQ(map.seenThrough(viewOf(5.2F), fromSensor), 0);
    EXPECT_EQ(map.seenThrough(odometry::RangeImage(), fromSensor), 0);
}

// A single post is no evidence.
TEST(FreeSpace, OfFewCellsIsHardlyBuiltOn) {
    const auto points = withWallAt(5.2F);
    const FreeSpace free(HeightImage(points), points);
    Eigen::Matrix3Xf ground = withWallAt(9.2F), post(3, ground.cols());
    Eigen::Index kept = 0;
    for (Eigen::Index i = 0; i < ground.cols(); ++i)
        if (ground(2, i) == 0 || (ground(1, i) > 9.9F && ground(1, i) < 10.2F))
            post.col(kept++) = ground.col(i);
    EXPECT_LT(free.conflict(HeightImage(post.leftCols(kept)), poseAt(0, 0, 0)), 0.1);
}

TEST(FreeSpace, OfNothingIsNotBuiltOn) {
    const Eigen::Matrix3Xf nothing(3, 0);
    const HeightImage none(nothing), wall(withWallAt(5));
    EXPECT_EQ(FreeSpace(none, nothing).conflict(wall, test::poseAt(0, 0, 0)), 0);
    EXPECT_EQ(FreeSpace(none, nothing).conflict(none, test::poseAt(0, 0, 0)), 0);
}
}  // namespace
