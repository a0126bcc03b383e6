#include "places/close_loops.h"

#include <gtest/gtest.h>

#include "town.h"

namespace {
using namespace delio;
using places::LoopCandidate;
using places::Submap;
using places_test::Poses;
using test::poseAt;

/** There and back again along x, 400 m each way, a submap every 20 m. */
class Loops : public testing::Test {
 protected:
    Loops() {
        for (std::size_t i = 0; i < 40; ++i) {
            const double x = 20 * static_cast<double>(i);
            poses.push_back(i < 20 ? poseAt(x, 0, 0) : test::poseAtDeg(780 - x, 0, 0, 180));
            Submap submap;
            submap.first = submap.key = submap.last = i;
            submap.driven.path_m = x;
            submaps.push_back(submap);
        }
    }
    /** Of two submaps, which was found `error` off the truth. */
    void found(std::size_t from, std::size_t to, const Eigen::Isometry3d& error) {
        LoopCandidate loop;
        loop.from = from;
        loop.to = to;
        loop.path_m = submaps[to].driven.path_m - submaps[from].driven.path_m;
        loop.closure.level = poses[from].inverse() * poses[to] * error;
        candidates.push_back(loop);
    }
    std::vector<std::string> reasons() {
        places::refuseInconsistent(candidates, submaps, poses, {});
        std::vector<std::string> texts;
        for (const auto& loop : candidates) texts.push_back(loop.closure.reason);
        return texts;
    }

    Poses poses;
    std::vector<Submap> submaps;
    std::vector<LoopCandidate> candidates;
};

TEST_F(Loops, ThatAgreeAreBelieved) {
    for (const std::size_t i : {3, 4, 5}) found(i, 39 - i, poseAt(1, 0.5, 2));
    EXPECT_EQ(reasons(), std::vector<std::string>(3, ""));
}

TEST_F(Loops, ThatStandAloneAreNot) {
    found(3, 36, poseAt(0, 0, 0));
    found(15, 24, poseAt(0, 0, 0));
    EXPECT_EQ(reasons(), std::vector<std::string>(2, "not confirmed by a neighbouring submap"));
}

TEST_F(Loops, ThatContradictMostAreNot) {
    for (const std::size_t i : {3, 4, 5, 6})
        found(i, 39 - i, i == 5 ? poseAt(6, 0, 0) : poseAt(0, 0, 0));
    EXPECT_EQ(reasons(), (std::vector<std::string>{"", "", "inconsistent with other loops", ""}));
}

TEST_F(Loops, ThatNoDriftExplainsAreNot) {
    for (const std::size_t i : {3, 4, 5}) found(i, 39 - i, poseAt(0, 40, 0));
    EXPECT_EQ(reasons(),
              std::vector<std::string>(3, "farther away than the odometry can have drifted"));
}
}  // namespace
