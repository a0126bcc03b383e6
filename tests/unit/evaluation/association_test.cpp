#include "delio/evaluation/association.h"

#include <gtest/gtest.h>

#include "delio/core/error.h"
#include "poses.h"

namespace {
using namespace delio;
using evaluation::associate;

/** Poses whose x is their stamp. */
io::Trajectory stamped(const std::vector<double>& stamps_s) {
    io::Trajectory trajectory;
    trajectory.stamps_s = stamps_s;
    for (const double t : stamps_s) trajectory.poses.push_back(test::poseAt(t, 0, 0));
    return trajectory;
}

io::Trajectory unstamped(std::size_t count) {
    io::Trajectory trajectory;
    trajectory.poses.assign(count, Eigen::Isometry3d::Identity());
    return trajectory;
}

std::vector<double> xOf(const std::vector<Eigen::Isometry3d>& poses) {
    std::vector<double> xs;
    for (const auto& pose : poses) xs.push_back(pose.translation().x());
    return xs;
}

std::string messageOf(const io::Trajectory& reference, const io::Trajectory& estimate) {
    try {
        associate(reference, estimate);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

TEST(Association, SaysWhichRowsBelongTogetherAndWhen) {
    const auto byRow = associate(stamped({5, 6, 7}), unstamped(3));
    EXPECT_EQ(byRow.estimateRows, (std::vector<std::size_t>{0, 1, 2}));
    EXPECT_EQ(byRow.stamps_s, (std::vector<double>{5, 6, 7}));
    EXPECT_TRUE(associate(unstamped(3), unstamped(3)).stamps_s.empty());
    const auto byStamp = associate(stamped({5, 6, 7}), stamped({4, 5.01, 7.01}));
    EXPECT_EQ(byStamp.estimateRows, (std::vector<std::size_t>{1, 2}));
    EXPECT_EQ(byStamp.stamps_s, (std::vector<double>{5, 7}));
}

TEST(Association, RowsMatchWhereEitherSideHasNoStamps) {
    EXPECT_EQ(associate(unstamped(3), unstamped(3)).estimate.size(), 3U);
    EXPECT_EQ(associate(stamped({5, 6, 7}), unstamped(3)).estimate.size(), 3U);
    EXPECT_EQ(associate(unstamped(3), stamped({5, 6, 7})).reference.size(), 3U);
}

TEST(Association, DifferentCountsOfRowsAreNamed) {
    const std::string message = messageOf(unstamped(61), unstamped(60));
    EXPECT_NE(message.find("61"), std::string::npos);
    EXPECT_NE(message.find("60"), std::string::npos);
}

TEST(Association, StampsMatchTheNearestWithinTheTolerance) {
    const auto matched =
        associate(stamped({0, 0.1, 0.2, 0.3, 0.4}), stamped({0.101, 0.195, 0.25, 0.419, 0.9}));
    EXPECT_EQ(xOf(matched.reference), (std::vector<double>{0.1, 0.2, 0.4}));
    EXPECT_EQ(xOf(matched.estimate), (std::vector<double>{0.101, 0.195, 0.419}));
    EXPECT_EQ(matched.unmatchedReference, 2U);
    EXPECT_EQ(matched.unmatchedEstimate, 2U);
}

TEST(Association, NoPoseIsUsedTwice) {
    // Three estimates near one pose of the reference, and the other way round.
    const auto dense = associate(stamped({1, 2}), stamped({0.99, 1.001, 1.01}));
    EXPECT_EQ(xOf(dense.estimate), (std::vector<double>{1.001}));
    const auto sparse = associate(stamped({0.99, 1.001, 1.01}), stamped({1, 2}));
    EXPECT_EQ(xOf(sparse.reference), (std::vector<double>{1.001}));
}

TEST(Association, EveryThirdPoseOfTheReferenceIsFound) {
    std::vector<double> all, third;
    for (int i = 0; i < 300; ++i) {
        all.push_back(1.3e9 + 0.1 * i);
        if (i % 3 == 0) third.push_back(all.back());
    }
    const auto matched = associate(stamped(all), stamped(third));
    EXPECT_EQ(xOf(matched.reference), third);
    EXPECT_EQ(matched.unmatchedReference, 200U);
    EXPECT_EQ(matched.unmatchedEstimate, 0U);
}

TEST(Association, NoMatchAtAllIsAnError) {
    EXPECT_NE(messageOf(stamped({0, 1, 2}), stamped({1000, 1001, 1002})).find("clock"),
              std::string::npos);
}
}  // namespace
