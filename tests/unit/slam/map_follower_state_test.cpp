#include <gtest/gtest.h>

#include <algorithm>

#include "../localisation/town_map.h"
#include "delio/slam/map_follower.h"
#include "states.h"

// Who follows a drive through a stored map goes on after any scan; the map is loaded again.
namespace {
using namespace delio;
using namespace delio::localisation_test;
using test::stateOf;

MapFollower followerIn(const test::TemporaryFolder& folder) {
    return MapFollower(MapTracker(std::make_shared<const StoredMap>(fileIn(folder)), {}, {}));
}

/** Along the street; for a while nothing is seen but another town. */
struct Seen {
    Seen() : poses(roundTheBlock(0)) {
        poses.resize(26);
        auto other = town(true);
        other.resize(20);
        test::Noise noise(3);
        for (std::size_t i = 0; i < poses.size(); ++i) {
            Step step;
            step.used.points = seenFrom(i < 8 || i > 15 ? town() : other, poses[i], noise);
            steps.push_back(step);
        }
    }
    void tell(MapFollower& follower, std::size_t i) const {
        Increment increment{Eigen::Isometry3d::Identity(), 1e-5 * Matrix6::Identity()};
        if (i > 0) increment.pose = poses[i - 1].inverse() * poses[i];
        follower.add({i, scan, steps[i], increment, poses[i]});
    }

    Poses poses;
    Scan scan;
    std::vector<Step> steps;
};

TEST(MapFollowerState, GoesOnAfterAnyScan) {
    const test::TemporaryFolder folder;
    {
        const TownDrive drive(roundTheBlock(0));
        StoredMap::save(drive.content, fileIn(folder));
    }
    const Seen seen;
    auto whole = followerIn(folder);
    std::vector<std::string> states;
    for (std::size_t i = 0; i < seen.poses.size(); ++i) {
        states.push_back(stateOf(whole));
        seen.tell(whole, i);
    }
    const auto& fixes = whole.fixes();
    const auto any = [&](std::size_t from, std::size_t to, const auto& is) {
        return std::any_of(fixes.begin() + static_cast<std::ptrdiff_t>(from),
                           fixes.begin() + static_cast<std::ptrdiff_t>(to), is);
    };
    const auto isInMap = [](const MapFix& fix) { return fix.where == Whereabouts::kInMap; };
    EXPECT_TRUE(any(0, 8, isInMap));
    EXPECT_TRUE(any(8, 20, [&](const MapFix& fix) { return !isInMap(fix); }));
    EXPECT_TRUE(any(20, 26, isInMap));
    for (const std::size_t count : {0U, 1U, 2U, 5U, 9U, 14U, 17U, 18U, 20U, 25U}) {
        SCOPED_TRACE(count);
        auto again = followerIn(folder);
        test::restore(again, states[count]);
        EXPECT_TRUE(stateOf(again) == states[count]);
        for (std::size_t i = count; i < seen.poses.size(); ++i) {
            seen.tell(again, i);
            ASSERT_EQ(again.fixes()[i].vehicle.pose.matrix(), fixes[i].vehicle.pose.matrix()) << i;
            ASSERT_EQ(again.fixes()[i].reason, fixes[i].reason) << i;
        }
        EXPECT_TRUE(stateOf(again) == stateOf(whole));
    }
}
}  // namespace
