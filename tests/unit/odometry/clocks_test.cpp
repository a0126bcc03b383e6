#include <gtest/gtest.h>

#include <functional>

#include "delio/run/doubts.h"
#include "odometry_drive.h"

// Pauses, and clocks that are set or stand still, in the midst of a drive.
namespace {
using namespace delio;
using namespace delio::odometry_test;
using Eigen::Isometry3d;

constexpr std::size_t kScans = 9, kAt = 5;  //!< what happens, happens before this scan

struct Clock {
    const char* name;
    std::function<double(std::size_t scan)> stamp_s;
    bool interrupts;
    double driven = 1;  //!< meanwhile, in usual steps
};

/** Ten scans a second, and a step of the clock. */
std::function<double(std::size_t)> steppedBy(double step_s, double start_s = 100) {
    return [=](std::size_t i) {
        return start_s + 0.1 * static_cast<double>(i) + (i < kAt ? 0 : step_s);
    };
}

const std::vector<Clock> kClocks = {
    {"Steady", steppedBy(0), false},
    {"AMinuteParked", steppedBy(60), true, 0},
    {"AMinuteInWhichItDroveOn", steppedBy(60), true, 6},
    {"AnHourForwards", steppedBy(3600), true},
    {"AnHourBackwards", steppedBy(-3600), true},
    {"ToTheEpoch", steppedBy(-1.7e9, 1.7e9), true},
    {"FromTheEpoch", steppedBy(1.7e9), true},
    {"ABitBackwards", steppedBy(-0.15), false},
    {"AlwaysZero", [](std::size_t) { return 0.0; }, false},
    {"EachTwice", [](std::size_t i) { return 0.2 * static_cast<double>(i / 2); }, false},
    {"NotANumber", [](std::size_t) { return std::nan(""); }, false},
};

class Clocks : public testing::TestWithParam<Clock> {};
INSTANTIATE_TEST_SUITE_P(PlaneOdometry, Clocks, testing::ValuesIn(kClocks),
                         [](const auto& clock) { return std::string(clock.param.name); });

TEST_P(Clocks, NoJumpOfThePoseAndOneWarning) {
    const auto& clock = GetParam();
    Poses truth{poseAtDeg(-4, 1, 0, 5)};
    while (truth.size() < kScans)
        truth.push_back(truth.back() *
                        poseAtDeg(0.5 * (truth.size() == kAt ? clock.driven : 1), 0, 0, -1));
    auto scans = scansOf(truth);
    for (std::size_t i = 0; i < kScans; ++i) scans[i].stamp_s = clock.stamp_s(i);
    const auto steps = stepsOf(scans, quick("accurate"));
    std::vector<run::RunRow> rows;
    for (std::size_t i = 0; i < kScans; ++i) {
        EXPECT_EQ(steps[i].interrupted, clock.interrupts && i == kAt) << i;
        EXPECT_FALSE(steps[i].predicted) << i << " " << steps[i].reason;
        run::RunRow row;
        row.scan = i;
        row.predicted = steps[i].predicted;
        row.interrupted = steps[i].interrupted;
        row.quality = steps[i].quality;
        rows.push_back(row);
        if (i == 0) continue;
        SCOPED_TRACE(i);
        expectPose(steps[i].increment.pose, stepTo(truth, i), 2 * kMetres, kDegrees);
    }
    EXPECT_EQ(run::warningsOf(run::doubtsOf(rows)).size(), clock.interrupts ? 1U : 0U);
}

class ElsewhereAfterAPause : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(PlaneOdometry, ElsewhereAfterAPause, testing::Bool(),
                         [](const auto& room) { return room.param ? "Room" : "Yard"; });

// It drove to another place meanwhile: nothing is known of the motion but the time it had. The
// ground is the same everywhere, and nothing to be found again by.
TEST_P(ElsewhereAfterAPause, SaysSoAndGoesOn) {
    auto scans = scansOf(drive(5));
    auto truth = drive(8);
    for (auto& pose : truth)
        if (!GetParam()) pose = poseAtDeg(14, -3, 0, 0) * pose;
    const auto elsewhere = scansOf(truth, GetParam() ? test::room() : test::yard());
    scans.insert(scans.end(), elsewhere.begin(), elsewhere.end());
    for (std::size_t i = 0; i < scans.size(); ++i) scans[i].stamp_s = steppedBy(60)(i);
    const auto steps = stepsOf(scans, quick("accurate"));
    EXPECT_TRUE(steps[kAt].predicted);
    EXPECT_TRUE(steps[kAt].interrupted);
    expectPose(steps[kAt].increment.pose, Isometry3d::Identity(), 1e-9, 1e-6);
    const auto& options = Options::ofProfile("accurate").planes.registration;
    EXPECT_NEAR(std::sqrt(steps[kAt].increment.covariance(0, 0)), 600 * options.prior_sigma, 1);
    // A new map is begun, in which the drive goes on.
    for (std::size_t i = 4; i < truth.size(); ++i) {
        EXPECT_FALSE(steps[kAt + i].predicted) << i << " " << steps[kAt + i].reason;
        expectPose(steps[kAt + i].increment.pose, stepTo(truth, i), kMetres, kDegrees);
    }
}

class Unregistered : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Odometry, Unregistered, testing::Values("accurate", "paper"),
                         [](const auto& profile) { return profile.param; });

TEST_P(Unregistered, ErrorsGrowWithTheTime) {
    auto scans = scansOf(drive(9));
    for (std::size_t i = 4; i < 8; ++i) scans[i] = test::scanOf({});
    for (std::size_t i = 0; i < scans.size(); ++i)
        scans[i].stamp_s = 0.1 * static_cast<double>(i) + (i < 7 ? 0 : 0.4);
    const auto steps = stepsOf(scans, quick(GetParam()));
    const auto sigmas = [&](std::size_t i) -> Vector6 {
        return steps[i].increment.covariance.diagonal().cwiseSqrt();
    };
    const double elapsed[] = {0.1, 0.2, 0.3, 0.8};
    for (std::size_t k = 1; k < 4; ++k) {
        const Vector6 growth = sigmas(4 + k).cwiseQuotient(sigmas(4)) * elapsed[0] / elapsed[k];
        EXPECT_GT(growth.minCoeff(), 1 - 1e-6);
        EXPECT_LT(growth.maxCoeff(), 3);
    }
    EXPECT_FALSE(steps[8].predicted);
    EXPECT_LT(sigmas(8)[0], 0.05);
}
}  // namespace
