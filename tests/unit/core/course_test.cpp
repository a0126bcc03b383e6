#include "core/scan_trajectory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "delio/core/error.h"
#include "tangents.h"

namespace {
using namespace delio;
using Eigen::Isometry3d;
using test::poseAt;

double difference(const Isometry3d& a, const Isometry3d& b) {
    return (a.matrix() - b.matrix()).norm();
}

Motion bend() {
    Motion motion;
    motion.velocity << 8, -0.4, 0.2;
    motion.turning << 0.3, -0.8, 1.9;
    return motion;
}

Course uneven() {
    return {{-0.1, -0.02, 0.03, 0.05},
            {poseAt(3, 4, 5, 0.3), poseAt(3.5, 4, 5, 0.2, 0.1), poseAt(3.6, 4.1, 5, 0.5),
             poseAt(3.6, 4.1, 5, 0.6)}};
}

TEST(Course, LeadsThroughItsPoses) {
    const Course course = uneven();
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_LT(difference(course.at(course.times_s()[i]), course.poses()[i]), 1e-12) << i;
}

TEST(Course, IsAtConstantTwistInBetweenAndBeyond) {
    const Course course = uneven();
    const auto half = [&](double from_s, double to_s) {
        const Isometry3d there = course.at(from_s).inverse() * course.at((from_s + to_s) / 2);
        return difference(there * there, course.at(from_s).inverse() * course.at(to_s));
    };
    EXPECT_LT(half(-0.1, -0.02), 1e-12);
    EXPECT_LT(half(-0.02, 0.03), 1e-12);
    EXPECT_LT(half(-0.17, -0.03), 1e-12);
    EXPECT_LT(half(0.04, 0.3), 1e-12);
    EXPECT_GT(half(-0.1, 0.03), 1e-2);
}

TEST(Course, OfOneMotionIsThatMotion) {
    const Course always = bend(),
                 parts = Course::even({-0.2, -0.1, 0.05}, bend().after(-0.2), bend());
    for (const double time_s : {-0.5, -0.1, 0.0, 0.02, 0.7}) {
        EXPECT_LT(difference(always.at(time_s), bend().after(time_s)), 1e-12) << time_s;
        EXPECT_LT(difference(parts.at(time_s), bend().after(time_s)), 1e-12) << time_s;
    }
}

TEST(Course, IsTheSameSeenFromAnywhereOnIt) {
    const Course course = uneven();
    for (const double from_s : {-0.1, 0.0, 0.2}) {
        const Course seen = course.seenFrom(from_s);
        EXPECT_LT(difference(seen.at(0), Isometry3d::Identity()), 1e-12);
        for (const double time_s : {-0.15, -0.05, 0.04, 0.1})
            EXPECT_LT(difference(course.at(from_s) * seen.at(time_s - from_s), course.at(time_s)),
                      1e-12);
    }
}

TEST(PoseTable, IsTheCourse) {
    const Course course(Motion{{20, 0, 0}, {2, -3, 6}});  // 7 rad/s
    const PoseTable table(course, -0.05, 0.05);
    for (double time_s = -0.05; time_s <= 0.05; time_s += 0.0007) {
        const Isometry3d off = course.at(time_s).inverse() * table.at(time_s);
        EXPECT_LT((off.linear() - Eigen::Matrix3d::Identity()).norm(), 2e-6) << time_s;
        EXPECT_LT(off.translation().norm(), 3e-6) << time_s;  // 135 m/s2
    }
    EXPECT_LT(difference(table.at(0.05), course.at(0.05)), 1e-12);
    EXPECT_LT(difference(PoseTable(course, 0.01, 0.01).at(0.01), course.at(0.01)), 1e-9);
}

TEST(Course, NeedsTwoPosesAtTimesThatIncrease) {
    const auto pose = Isometry3d::Identity();
    EXPECT_THROW(Course({}, {}), Error);
    EXPECT_THROW(Course({0}, {pose}), Error);
    EXPECT_THROW(Course({0, 1}, {pose}), Error);
    EXPECT_THROW(Course({0}, {pose, pose}), Error);
    EXPECT_THROW(Course({0, 0}, {pose, pose}), Error);
    EXPECT_THROW(Course({0, 1, 0.5}, {pose, pose, pose}), Error);
    EXPECT_THROW(Course({0, std::nan("")}, {pose, pose}), Error);
    EXPECT_NO_THROW(Course({0, 1}, {pose, pose}));
}
}  // namespace
