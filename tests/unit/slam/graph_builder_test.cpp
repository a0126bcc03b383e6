#include "delio/slam/listeners.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "slam_drive.h"

namespace {
using namespace delio;
using namespace delio::slam_test;

/** A drive whose scans a graph builder can be told of one by one. */
class Told {
 public:
    explicit Told(const Options& options) {
        const auto odometry = makeOdometry(options);
        for (const auto& scan : scans_) {
            steps_.push_back(odometry->process(scan));
            poses_.push_back(poses_.empty() ? steps_.back().increment.pose
                                            : poses_.back() * steps_.back().increment.pose);
        }
    }

    std::size_t size() const { return scans_.size(); }
    SlamScan at(std::size_t i) const {
        return {i, scans_[i], steps_[i], steps_[i].increment, poses_[i]};
    }

 private:
    std::vector<Scan> scans_ = scansOf(drive(7));
    std::vector<Step> steps_;
    Poses poses_;
};

Options withWindow() {
    Options options = withSkipEdges(2);
    options.graph.window = 4;
    return options;
}

TEST(GraphBuilder, EachScanGetsItsEdgesAndMovesTheWindow) {
    const Told drive(withWindow());
    GraphBuilder builder(withWindow().graph);
    for (std::size_t i = 0; i < drive.size(); ++i) {
        const graph::PoseGraph before = builder.graph();
        builder.add(drive.at(i));
        const graph::PoseGraph& after = builder.graph();
        ASSERT_EQ(after.poses().size(), i + 1);
        EXPECT_EQ(after.edges().size(), before.edges().size() + std::min<std::size_t>(i, 3)) << i;
        if (i >= 3) {
            EXPECT_NE(after.poses()[i - 1].matrix(), before.poses()[i - 1].matrix()) << i;
        }
    }
}

// A scan may know better where the scans before it were: their nodes move, and the chain with them.
TEST(GraphBuilder, CorrectedPosesMoveTheirNodes) {
    constexpr double kExact_m = 1e-12;
    const Told drive{Options()};
    GraphBuilder builder{graph::PoseGraphOptions()};
    const std::size_t last = drive.size() - 1;
    for (std::size_t i = 0; i < last; ++i) builder.add(drive.at(i));
    SlamScan told = drive.at(last);
    const Eigen::Isometry3d moved = told.pose * Eigen::Translation3d(-2, 0.5, 0);
    told.corrected = {{last - 1, moved}};
    builder.add(told);
    const auto& poses = builder.graph().poses();
    EXPECT_TRUE(poses[last - 1].isApprox(moved, kExact_m));
    EXPECT_TRUE(poses[last - 2].isApprox(drive.at(last - 2).pose, kExact_m));
    EXPECT_TRUE(poses[last].isApprox(told.pose, kExact_m));
    for (const auto& [from, to, increment] : builder.graph().edges())
        EXPECT_TRUE(increment.pose.isApprox(poses[from].inverse() * poses[to], kExact_m)) << from;
}

// An odometry may keep features of some scans only.
TEST(GraphBuilder, AScanWithoutFeaturesHasNoSkipEdges) {
    const Told drive(withWindow());
    GraphBuilder builder(withWindow().graph);
    for (std::size_t i = 0; i < drive.size(); ++i) {
        const SlamScan told = drive.at(i);
        Step step = told.step;
        if (i == 3) step.features.reset();
        builder.add({told.node, told.scan, step, told.increment, told.pose});
    }
    EXPECT_TRUE(isThere(builder.graph(), 3, 4));
    EXPECT_FALSE(isThere(builder.graph(), 1, 3));
    EXPECT_FALSE(isThere(builder.graph(), 3, 5));
    EXPECT_TRUE(isThere(builder.graph(), 2, 4));
    EXPECT_TRUE(isThere(builder.graph(), 4, 6));
}
}  // namespace
