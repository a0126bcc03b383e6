#include "places/join_maps.h"

#include <gtest/gtest.h>

#include "delio/core/error.h"
#include "town_map.h"

namespace {
using namespace delio;
using namespace delio::localisation_test;

std::vector<MapFix> fixesOf(const Poses& poses, std::size_t from, std::size_t to) {
    std::vector<MapFix> fixes(poses.size());
    for (std::size_t i = from; i < to; ++i) {
        fixes[i].where = Whereabouts::kInMap;
        fixes[i].measured = true;
        fixes[i].vehicle = {poses[i], 1e-4 * Matrix6::Identity()};
    }
    return fixes;
}

class Joining : public testing::Test {
 protected:
    /** The first two streets are mapped; the second drive goes on round the block. */
    Joining()
        : there_(roundTheBlock(0)),
          first_(Poses(there_.begin(), there_.begin() + 48)),
          second_(Poses(there_.begin() + 5, there_.end())) {
        const TownDrive drive(first_, town(), "first");
        StoredMap::save(drive.content, fileIn(folder_));
    }
    JoinedMap join(const TownDrive& drive, const std::vector<MapFix>& fixes) const {
        return joined(map_(), drive.content, fixes, {}, {}, {});
    }
    const StoredMap& map_() const {
        if (!opened_) opened_ = std::make_unique<StoredMap>(fileIn(folder_));
        return *opened_;
    }

    test::TemporaryFolder folder_;
    Poses there_, first_, second_;
    mutable std::unique_ptr<StoredMap> opened_;
};

TEST_F(Joining, WhatIsNewIsAdded) {
    const TownDrive drive(second_, town(), "second");
    const auto both = join(drive, fixesOf(second_, 0, 43));
    EXPECT_GE(both.accepted, 2U);
    EXPECT_GE(both.added, 2U);
    EXPECT_LT(both.added, drive.submaps.size());
    ASSERT_EQ(both.content.graph.poses().size(), first_.size() + second_.size());
    for (std::size_t i = 0; i < second_.size(); ++i)
        EXPECT_LT(test::metresBetween(both.content.graph.poses()[first_.size() + i], second_[i]),
                  0.05)
            << i;
    ASSERT_EQ(both.content.drives.size(), 2U);
    EXPECT_EQ(both.content.drives[1].name, "second");
    EXPECT_EQ(both.content.drives[1].firstNode, first_.size());

    // As a file, with all that was in it.
    StoredMap::save(both.content, fileIn(folder_, "both.delio"));
    const StoredMap map(fileIn(folder_, "both.delio"));
    EXPECT_EQ(map.submaps().size(), map_().submaps().size() + both.added);
    for (std::size_t i = 0; i < map.submaps().size(); ++i) {
        const auto& submap = map.submaps()[i];
        EXPECT_GT(map.points(i).cols(), 1000);
        const auto& truth =
            submap.key < first_.size() ? first_[submap.key] : second_[submap.key - first_.size()];
        EXPECT_LT(test::metresBetween(map.levelFrames()[i], truth), 0.05);
    }
    EXPECT_GT(map.cloud(0.5).cols(), map_().cloud(0.5).cols());
}

// What lies a little off is drawn to where the two maps fit.
TEST_F(Joining, SubmapsSayWhereTheDriveIs) {
    Poses off = second_;
    for (auto& pose : off) pose = test::poseAt(0.25, -0.2, 0.1) * pose;
    const TownDrive seen(second_, town(), "second");
    auto content = seen.content;
    content.graph = chainOf(off);
    const auto both = joined(map_(), content, fixesOf(off, 0, 43), {}, {}, {});
    ASSERT_GE(both.accepted, 2U);
    for (std::size_t i = 0; i < second_.size(); ++i)
        EXPECT_LT(test::metresBetween(both.content.graph.poses()[first_.size() + i], second_[i]),
                  0.05)
            << i;
}

TEST_F(Joining, ADriveThatIsNotThereIsNotJoined) {
    // It claims to have been found, but 8 m beside: nothing fits.
    Poses wrong = second_;
    for (auto& pose : wrong) pose = test::poseAt(0, 8, 0) * pose;
    const TownDrive seen(second_, town(), "second");
    auto content = seen.content;
    content.graph = chainOf(wrong);
    EXPECT_EQ(joined(map_(), content, fixesOf(wrong, 0, 43), {}, {}, {}).accepted, 0U);
    EXPECT_EQ(join(seen, std::vector<MapFix>(second_.size())).joints.size(), 0U);
}

TEST(AnchoredGraph, GoesThroughWhatWasMeasured) {
    // The odometry stretches by 2 %; the first and the last scans were measured.
    Poses truth, odometry;
    for (int i = 0; i < 21; ++i) {
        truth.push_back(test::poseAtDeg(100, 50, 3, 30) * test::poseAt(i, 0, 0));
        odometry.push_back(test::poseAt(1.02 * i, 0, 0));
    }
    std::vector<MapFix> fixes(truth.size());
    for (const std::size_t i : {2U, 3U, 20U}) {
        fixes[i].where = Whereabouts::kInMap;
        fixes[i].measured = true;
        fixes[i].vehicle = {truth[i], 1e-6 * Matrix6::Identity()};
    }
    auto graph = anchored(chainOf(odometry, 0.05, 0.01), fixes);
    EXPECT_LT(test::metresBetween(graph.poses()[3], truth[3]), 1e-9);
    EXPECT_LT(test::metresBetween(graph.poses()[10], truth[3] * test::poseAt(1.02 * 7, 0, 0)),
              1e-9);
    graph.optimise({});
    EXPECT_LT(test::metresBetween(graph.poses()[10], truth[10]), 0.06);
    EXPECT_LT(test::metresBetween(graph.poses()[20], truth[20]), 0.06);
    EXPECT_THROW(anchored(chainOf(odometry), std::vector<MapFix>(odometry.size())), Error);
}
}  // namespace
