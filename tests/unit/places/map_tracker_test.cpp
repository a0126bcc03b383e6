#include "places/map_tracker.h"

#include <gtest/gtest.h>

#include "places/join_maps.h"
#include "town_map.h"

namespace {
using namespace delio;
using namespace delio::localisation_test;

/** The town as it was driven through once. */
class InTheTown : public testing::Test {
 protected:
    void SetUp() override {
        const TownDrive drive(roundTheBlock(0));
        StoredMap::save(drive.content, fileIn(folder_));
        map_ = std::make_shared<const StoredMap>(fileIn(folder_));
    }
    MapTracker tracker() const { return MapTracker(map_, {}, {}); }

    /** Fixes along these poses; each step off by `slip`. */
    static std::vector<MapFix> follow(MapTracker& tracker, const Poses& poses,
                                      const test::Scene& scene, double slip = 0) {
        test::Noise noise(3);
        std::vector<MapFix> fixes;
        for (std::size_t i = 0; i < poses.size(); ++i) {
            Increment step{Eigen::Isometry3d::Identity(), 1e-5 * Matrix6::Identity()};
            if (i > 0) step.pose = poses[i - 1].inverse() * poses[i];
            step.pose.translation() *= 1 + slip;
            fixes.push_back(
                tracker.add(step, seenFrom(scene, poses[i], noise), Eigen::Vector3d::UnitZ()));
        }
        return fixes;
    }
    static void expectAt(const MapFix& fix, const Eigen::Isometry3d& truth, double metres = 0.05) {
        EXPECT_LT(test::metresBetween(fix.vehicle.pose, truth), metres);
        EXPECT_LT(angleOf(fix.vehicle.pose.linear().transpose() * truth.linear()), 0.01);
    }
    /** A lane beside the mapped one, the other way. */
    static Poses theOtherWay(std::size_t from, std::size_t count) {
        const auto there = roundTheBlock(0);
        Poses poses;
        for (std::size_t i = from; i > from - count; --i)
            poses.push_back(there[i] * test::poseAt(0, 2, 0) * test::poseAtDeg(0, 0, 0, 180));
        return poses;
    }

    test::TemporaryFolder folder_;
    std::shared_ptr<const StoredMap> map_;
};

TEST_F(InTheTown, AVehicleIsFoundAnywhereAndFollowed) {
    const auto there = roundTheBlock(0);
    for (const std::size_t start : {3U, 20U, 40U, 60U, 80U}) {
        const Poses poses(there.begin() + static_cast<std::ptrdiff_t>(start),
                          there.begin() + static_cast<std::ptrdiff_t>(start) + 8);
        auto one = tracker();
        const auto fixes = follow(one, poses, town(), 0.01);
        EXPECT_TRUE(fixes.front().searched);
        EXPECT_EQ(fixes.front().where, Whereabouts::kUnknown);  // nothing has confirmed it yet
        for (std::size_t i = 4; i < fixes.size(); ++i) {
            EXPECT_TRUE(isAnchor(fixes[i])) << start << " " << i << " " << fixes[i].reason;
            EXPECT_FALSE(fixes[i].searched);
            EXPECT_GT(fixes[i].inlierRatio, 0.6);
            EXPECT_LT(fixes[i].vehicle.covariance.diagonal().maxCoeff(), 0.01);
            expectAt(fixes[i], poses[i]);
        }
    }
}

TEST_F(InTheTown, TheOtherWayToo) {
    const auto poses = theOtherWay(22, 8);
    auto one = tracker();
    const auto fixes = follow(one, poses, town());
    ASSERT_TRUE(isAnchor(fixes.back())) << fixes.back().reason;
    expectAt(fixes.back(), poses.back());
}

// The map ends 1 m above the sensor; most of what a scan sees of the houses is higher.
TEST_F(InTheTown, ASensorThatSeesHigherThanTheMaps) {
    TownDrive low(roundTheBlock(0));
    for (auto& submap : low.submaps) {
        Eigen::Index kept = 0;
        for (Eigen::Index i = 0; i < submap.points.cols(); ++i)
            if (submap.points(2, i) < 1) submap.points.col(kept++) = submap.points.col(i);
        submap.points.conservativeResize(3, kept);
    }
    StoredMap::save(low.content, fileIn(folder_, "low.delio"));
    MapTracker tracker(std::make_shared<const StoredMap>(fileIn(folder_, "low.delio")), {}, {});
    test::Noise noise(3);
    const auto poses = roundTheBlock(0);
    const test::Sensor high{24, 360, -10, 40, 0.01};
    std::size_t standing = 0, higher = 0;
    MapFix fix;
    for (std::size_t i = 20; i < 26; ++i) {
        const auto points = test::ringScan(town(), poses[i], high, noise).points;
        for (Eigen::Index k = 0; k < points.cols(); ++k) {
            standing += points(2, k) > -1.4F;
            higher += points(2, k) > 1.3F;
        }
        Increment step{Eigen::Isometry3d::Identity(), 1e-5 * Matrix6::Identity()};
        if (i > 20) step.pose = poses[i - 1].inverse() * poses[i];
        fix = tracker.add(step, points, Eigen::Vector3d::UnitZ());
    }
    EXPECT_GT(2 * higher, standing);
    ASSERT_TRUE(isAnchor(fix)) << fix.reason;
    EXPECT_GT(fix.inlierRatio, 0.6);
    expectAt(fix, poses[25]);
}

// Another vehicle, whose sensor is mounted elsewhere.
TEST_F(InTheTown, AtAnotherHeightToo) {
    Poses poses;
    for (int i = 0; i < 8; ++i) poses.push_back(test::poseAt(20 + 2.0 * i, 0, 0.6));
    auto one = tracker();
    const auto fixes = follow(one, poses, town());
    ASSERT_TRUE(isAnchor(fixes.back())) << fixes.back().reason;
    expectAt(fixes.back(), poses.back());
}

TEST_F(InTheTown, WhoIsElsewhereIsNotFound) {
    test::Scene other{{{-100, -100, -2.8}, {160, 140, -1.8}}};
    test::Noise noise(99);
    for (int i = -4; i < 10; ++i)
        for (const double y : {-14.0, 9.0, 31.0, 50.0}) {
            const double x = 17 * i + 3 * noise.uniform();
            other.push_back({{x, y + noise.uniform(), -2}, {x + 9, y + 5, 4 + noise.uniform()}});
        }
    auto one = tracker();
    for (const auto& fix : follow(one, roundTheBlock(0), other)) {
        EXPECT_EQ(fix.where, Whereabouts::kUnknown);
        EXPECT_FALSE(fix.reason.empty());
    }
}

TEST_F(InTheTown, WhoLeavesIsTakenByTheOdometryAndFoundAgain) {
    // Out of the mapped town, to where there are other houses, and back.
    Poses poses;
    for (int i = 0; i < 90; ++i) poses.push_back(test::poseAt(48 - 2.0 * i, 0, 0));
    for (int i = 89; i > 20; --i)
        poses.push_back(test::poseAt(48 - 2.0 * i, 2.5, 0) * test::poseAtDeg(0, 0, 0, 180));
    auto scene = town();
    scene[0].low.x() = -400;
    for (int i = 0; i < 20; ++i)
        for (const double y : {-13.0, 9.0})
            scene.push_back({{-250 + 11.0 * i, y, -2}, {-244 + 10.0 * i, y + 4, 3 + 0.2 * i}});
    auto one = tracker();
    const auto fixes = follow(one, poses, scene, 0.003);
    std::size_t inMap = 0, outside = 0;
    for (std::size_t i = 0; i < fixes.size(); ++i) {
        inMap += fixes[i].where == Whereabouts::kInMap;
        outside += fixes[i].where == Whereabouts::kOutside;
        if (isAnchor(fixes[i])) expectAt(fixes[i], poses[i], 0.1);
        if (fixes[i].where != Whereabouts::kUnknown) expectAt(fixes[i], poses[i], 2);
    }
    EXPECT_GT(outside, 30U);
    EXPECT_GT(inMap, 30U);
    EXPECT_TRUE(isAnchor(fixes.back()));
    // What it may be off grows outside.
    const auto left = std::find_if(fixes.begin(), fixes.end(), [](const MapFix& fix) {
        return fix.where == Whereabouts::kOutside;
    });
    EXPECT_GT((left + 20)->vehicle.covariance.trace(), left->vehicle.covariance.trace());
}

TEST_F(InTheTown, WhoIsSaidToBeSomewhereIsLookedForThere) {
    const auto there = roundTheBlock(0);
    const Poses poses(there.begin() + 30, there.begin() + 38);
    auto near = tracker();
    near.expect(poses.front() * test::poseAtDeg(1.5, -1, 0, 4));
    expectAt(follow(near, poses, town()).back(), poses.back());
    auto far = tracker();
    far.expect(poses.front() * test::poseAt(-60, 0, 0));
    for (const auto& fix : follow(far, poses, town())) EXPECT_FALSE(isAnchor(fix));
}

TEST_F(InTheTown, ScansWithoutPointsAreNoReasonToStop) {
    auto one = tracker();
    const Eigen::Matrix3Xf none(3, 0);
    const Increment step{Eigen::Isometry3d::Identity(), 1e-5 * Matrix6::Identity()};
    for (int i = 0; i < 10; ++i) {
        const auto fix = one.add(step, none, Eigen::Vector3d::UnitZ());
        EXPECT_EQ(fix.where, Whereabouts::kUnknown);
    }
    const auto there = roundTheBlock(0);
    auto fixes = follow(one, {there.begin() + 20, there.begin() + 40}, town());
    ASSERT_TRUE(isAnchor(fixes.back())) << fixes.back().reason;
    const auto blind = one.add(step, none, Eigen::Vector3d::UnitZ());
    EXPECT_EQ(blind.where, Whereabouts::kInMap);
    EXPECT_FALSE(blind.measured);
    EXPECT_EQ(blind.reason, "no points");
}

TEST_F(InTheTown, AMapWithoutSubmapsFindsNothing) {
    StoredMap::save({}, fileIn(folder_, "empty.delio"));
    MapTracker one(std::make_shared<const StoredMap>(fileIn(folder_, "empty.delio")), {}, {});
    for (const auto& fix : follow(one, roundTheBlock(0), town()))
        EXPECT_EQ(fix.where, Whereabouts::kUnknown);
}
}  // namespace
