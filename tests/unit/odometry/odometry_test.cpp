#include "delio/odometry/odometry.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "delio/slam/options.h"
#include "ring_scan.h"

namespace {
using namespace delio;
using mrpt::poses::CPose3D;
using test::degreesBetween;

CPose3D poseOf(double x, double y, double z, double yaw_deg, double pitch_deg, double roll_deg) {
    const double deg = M_PI / 180;
    return CPose3D::FromXYZYawPitchRoll(x, y, z, yaw_deg * deg, pitch_deg * deg, roll_deg * deg);
}

/** A drive through the yard: half a metre a scan, bending, with a little pitch and roll. */
std::vector<CPose3D> drive(std::size_t count) {
    std::vector<CPose3D> poses{poseOf(-3, 1, 0, 15, 0, 0)};
    while (poses.size() < count) {
        const auto k = static_cast<double>(poses.size());
        poses.push_back(poses.back() + poseOf(0.45 + 0.02 * k, 0.01, 0, -1.5, 0.2 * std::cos(k),
                                              0.2 * std::sin(k)));
    }
    return poses;
}

Scan scanAt(const CPose3D& pose, std::uint32_t seed, const test::Scene& scene = test::yard()) {
    test::Noise noise(seed);
    return test::scanOf(test::ringScan(scene, pose, {28, 400, -24, 8, 0.01}, noise).points);
}

std::vector<Scan> scansOf(const std::vector<CPose3D>& poses,
                          const test::Scene& scene = test::yard()) {
    std::vector<Scan> scans;
    for (const auto& pose : poses)
        scans.push_back(scanAt(pose, static_cast<std::uint32_t>(scans.size()), scene));
    return scans;
}

Scan emptyScan() { return test::scanOf({}); }

Scan scanOfNaN() {
    return test::scanOf(
        Eigen::Matrix3Xf::Constant(3, 5000, std::numeric_limits<float>::quiet_NaN()));
}

Scan fewPoints() {
    test::Noise noise;
    Eigen::Matrix3Xf points(3, 10);
    for (int i = 0; i < 10; ++i) points.col(i) = (10 * noise.direction()).cast<float>();
    return test::scanOf(points);
}

/** The first pair is searched in a smaller disc, or not at all, which takes its time else. */
OdometryOptions quick(const std::string& profile = "paper", double search_radius = 0) {
    auto options = Options::ofProfile(profile).odometry;
    options.lineRegistration.search_radius = search_radius;
    return options;
}

std::vector<OdometryResult> resultsOf(const std::vector<Scan>& scans,
                                      const OdometryOptions& options = quick()) {
    Odometry odometry(options);
    std::vector<OdometryResult> results;
    results.reserve(scans.size());
    for (const auto& scan : scans) results.push_back(odometry.process(scan));
    return results;
}

void expectCovariance(const Increment& increment) {
    const Eigen::Matrix<double, 6, 6> C = increment.covariance.asEigen();
    EXPECT_TRUE(C.allFinite());
    EXPECT_LE((C - C.transpose()).norm(), 1e-12 * C.norm());
    EXPECT_EQ(C.llt().info(), Eigen::Success) << C;
}

void expectPose(const CPose3D& found, const CPose3D& truth, double metres, double degrees) {
    EXPECT_LT(found.distanceTo(truth), metres) << found << " for " << truth;
    EXPECT_LT(degreesBetween(found, truth), degrees) << found << " for " << truth;
}

constexpr double kMetres = 0.02, kDegrees = 0.2;

TEST(Odometry, FindsTheIncrementsOfADrive) {
    const auto truth = drive(6);
    const auto results = resultsOf(scansOf(truth), quick("paper", 1));
    EXPECT_FALSE(results[0].predicted);
    EXPECT_EQ(results[0].increment.pose, CPose3D());
    for (std::size_t i = 1; i < truth.size(); ++i) {
        const auto& result = results[i];
        EXPECT_FALSE(result.predicted) << result.reason;
        EXPECT_EQ(result.reason, "");
        expectPose(result.increment.pose, truth[i] - truth[i - 1], kMetres, kDegrees);
        expectCovariance(result.increment);
        EXPECT_EQ(result.counts.notFinite, 0U);
        EXPECT_GT(result.counts.points, 8000U);
        EXPECT_GT(result.counts.normals, result.counts.pattern);
        EXPECT_GT(result.counts.pattern, 500U);
        EXPECT_GT(result.counts.lines, 2500U);
        EXPECT_EQ(static_cast<Eigen::Index>(result.counts.lines),
                  result.features->lines.midpoints.cols());
        for (const double ms : result.times_ms) EXPECT_GE(ms, 0);
    }
}

// 25 m/s from the first scan on, of which nothing is known before.
TEST(Odometry, ADriveThatBeginsAtSpeedIsRegistered) {
    for (const std::string profile : {"paper", "accurate"}) {
        std::vector<CPose3D> truth{poseOf(-7, 1, 0, 20, 0, 0)};
        while (truth.size() < 4) truth.push_back(truth.back() + poseOf(2.5, 0, 0, 1, 0, 0));
        const auto results = resultsOf(scansOf(truth), Options::ofProfile(profile).odometry);
        for (std::size_t i = 1; i < truth.size(); ++i) {
            EXPECT_FALSE(results[i].predicted) << profile << i;
            expectPose(results[i].increment.pose, truth[i] - truth[i - 1], 0.1, 0.5);
        }
    }
}

// At a constant speed, but scans are missing: what is expected of a step grows with its time.
TEST(Odometry, DroppedScansAreBridged) {
    std::vector<CPose3D> truth{poseOf(-4, 0, 0, 10, 0, 0)};
    std::vector<double> stamps{100};
    for (const int missing : {0, 0, 0, 2, 0, 3, 0}) {
        CPose3D pose = truth.back();
        for (int i = 0; i <= missing; ++i) pose = pose + poseOf(0.5, 0, 0, -2.5, 0, 0);
        truth.push_back(pose);
        stamps.push_back(stamps.back() + 0.1 * (missing + 1));
    }
    auto scans = scansOf(truth);
    for (std::size_t i = 0; i < scans.size(); ++i) scans[i].stamp_s = stamps[i];
    for (const std::string profile : {"paper", "accurate"}) {
        const auto results = resultsOf(scans, quick(profile, 1));
        for (std::size_t i = 1; i < truth.size(); ++i) {
            EXPECT_FALSE(results[i].predicted) << profile << i;
            expectPose(results[i].increment.pose, truth[i] - truth[i - 1], 0.05, 0.5);
        }
    }
}

// Scans of one place, each with its own noise.
TEST(Odometry, AVehicleAtRestStaysThere) {
    const CPose3D place = poseOf(0, 0, 0, 30, 0, 0);
    std::vector<Scan> scans;
    for (std::uint32_t seed = 0; seed < 4; ++seed) scans.push_back(scanAt(place, seed));
    const auto results = resultsOf(scans);
    for (std::size_t i = 1; i < results.size(); ++i) {
        EXPECT_FALSE(results[i].predicted);
        expectPose(results[i].increment.pose, {}, 0.005, 0.05);
    }
}

// Stop and go: every step is predicted too short.
TEST(Odometry, AVehicleThatStartsFromRestIsFollowed) {
    std::vector<CPose3D> truth(2, poseOf(0, 0, 0, 30, 0, 0));
    for (const double step : {0.03, 0.06, 0.12, 0.2, 0.3})
        truth.push_back(truth.back() + poseOf(step, 0, 0, 0, 0, 0));
    const auto results = resultsOf(scansOf(truth, test::room()));
    for (std::size_t i = 1; i < truth.size(); ++i)
        expectPose(results[i].increment.pose, truth[i] - truth[i - 1], kMetres, kDegrees);
}

TEST(Odometry, AScanThatIsThereTwiceIsNoMotion) {
    const auto truth = drive(4);
    for (const auto& profile : Options::profileNames()) {
        const auto options = quick(profile);
        const auto atRest = resultsOf({scanAt(truth[0], 0), scanAt(truth[0], 0)}, options);
        EXPECT_FALSE(atRest[1].predicted) << profile << ": " << atRest[1].reason;
        // Not to the last digit: each scan has its own draw of lines, through points with noise.
        expectPose(atRest[1].increment.pose, {}, 3e-3, 1e-3);
        expectCovariance(atRest[1].increment);
    }
    // And in the middle of a drive, where half a metre was predicted.
    auto scans = scansOf(truth);
    scans.insert(scans.begin() + 3, scans[2]);
    const auto results = resultsOf(scans);
    EXPECT_FALSE(results[3].predicted) << results[3].reason;
    expectPose(results[3].increment.pose, {}, 0.01, 0.01);
    expectCovariance(results[3].increment);
    expectPose(results[4].increment.pose, truth[3] - truth[2], kMetres, kDegrees);
}

class BadScan : public testing::TestWithParam<std::pair<const char*, const char*>> {
 protected:
    static Scan scan() {
        const std::string kind = GetParam().first;
        return kind == "empty" ? emptyScan() : kind == "NaN" ? scanOfNaN() : fewPoints();
    }
};

TEST_P(BadScan, InTheMiddleIsPredictedAndTheNextOneIsRightAgain) {
    const auto truth = drive(7);
    auto scans = scansOf(truth);
    scans[4] = scan();
    const auto results = resultsOf(scans);
    EXPECT_TRUE(results[4].predicted);
    EXPECT_EQ(results[4].reason, GetParam().second);
    // The prediction: a drive as steady as this one goes on within centimetres.
    expectPose(results[4].increment.pose, truth[4] - truth[3], 0.1, 1);
    expectCovariance(results[4].increment);
    EXPECT_GT(results[4].increment.covariance(0, 0), 0.01);  // and says that it is none too sure
    for (const std::size_t i : {1, 2, 3, 5, 6}) EXPECT_FALSE(results[i].predicted) << i;
    // The next one is registered against the scan before the gap: together they are right.
    expectPose(results[5].registration.increment.pose, truth[5] - truth[3], kMetres, kDegrees);
    expectPose(results[4].increment.pose + results[5].increment.pose, truth[5] - truth[3], kMetres,
               kDegrees);
    expectPose(results[6].increment.pose, truth[6] - truth[5], kMetres, kDegrees);
    CPose3D pose = truth[0];
    for (const auto& result : results) pose = pose + result.increment.pose;
    expectPose(pose, truth[6], 3 * kMetres, 3 * kDegrees);
}

TEST_P(BadScan, AtTheStartIsNoReference) {
    const auto truth = drive(3);
    auto scans = scansOf(truth);
    scans.insert(scans.begin(), scan());
    const auto results = resultsOf(scans);
    EXPECT_TRUE(results[0].predicted);
    EXPECT_EQ(results[0].reason, GetParam().second);
    EXPECT_EQ(results[0].increment.pose, CPose3D());
    EXPECT_EQ(results[1].increment.pose, CPose3D());
    EXPECT_TRUE(results[1].predicted);  // no motion, but not a silent one
    EXPECT_EQ(results[1].reason, "no usable scan before it");
    expectPose(results[2].increment.pose, truth[1] - truth[0], kMetres, kDegrees);
    expectPose(results[3].increment.pose, truth[2] - truth[1], kMetres, kDegrees);
    EXPECT_FALSE(results[2].predicted);
    for (const auto& result : results) expectCovariance(result.increment);
}

TEST_P(BadScan, AndNothingElse) {
    const auto results = resultsOf({scan(), scan(), scan()});
    for (const auto& result : results) {
        EXPECT_TRUE(result.predicted);
        EXPECT_NE(result.reason, "");
        EXPECT_EQ(result.increment.pose, CPose3D());
        expectCovariance(result.increment);
    }
}

TEST_P(BadScan, AsTheSecondIsNotTakenForARest) {
    const auto truth = drive(4);
    auto scans = scansOf(truth);
    scans[1] = scan();
    const auto results = resultsOf(scans, quick("paper", 1));
    EXPECT_TRUE(results[1].predicted);
    EXPECT_FALSE(results[2].predicted) << results[2].reason;
    expectPose(results[1].increment.pose + results[2].increment.pose, truth[2] - truth[0], kMetres,
               kDegrees);
    expectPose(results[3].increment.pose, truth[3] - truth[2], kMetres, kDegrees);
}

INSTANTIATE_TEST_SUITE_P(Odometry, BadScan,
                         testing::Values(std::pair("empty", "no points"),
                                         std::pair("NaN", "no points"),
                                         std::pair("ten", "no surfaces")));

TEST(Odometry, PointsThatAreNotFiniteAreCountedAndNoMore) {
    const auto truth = drive(3);
    auto scans = scansOf(truth);
    for (int i = 0; i < 300; ++i)
        scans[1].points->insertPointFast(std::numeric_limits<float>::quiet_NaN(), 1, 1);
    const auto results = resultsOf(scans);
    EXPECT_EQ(results[1].counts.notFinite, 300U);
    EXPECT_FALSE(results[1].predicted);
    expectPose(results[1].increment.pose, truth[1] - truth[0], kMetres, kDegrees);
}

TEST(Odometry, AlignsAnyTwoScans) {
    const auto truth = drive(5);
    const auto scans = scansOf(truth);
    Odometry odometry(quick());
    const auto last = odometry.process(scans[4]).features,
               first = odometry.process(scans[2]).features;
    StageTimes times{};
    const auto found = odometry.align(
        *last, *first, (truth[2] - truth[4]) + poseOf(0.2, 0.1, 0, 1, 0, 0), 0, times);
    EXPECT_EQ(found.predictedReason, "");
    expectPose(found.increment.pose, truth[2] - truth[4], kMetres, kDegrees);
    expectCovariance(found.increment);
    EXPECT_EQ(times[kNormals], 0);
    EXPECT_GT(times[kRotation], 0);
}

TEST(Odometry, OneAndTwoThreadsGiveTheSameBytes) {
    const auto scans = scansOf(drive(4));
    const auto with = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return resultsOf(scans);
    };
    const auto one = with(1), two = with(2);
    for (std::size_t i = 0; i < scans.size(); ++i) {
        const auto &a = one[i], &b = two[i];
        EXPECT_EQ(a.increment.pose.m_coords, b.increment.pose.m_coords);
        EXPECT_EQ(a.increment.pose.getRotationMatrix(), b.increment.pose.getRotationMatrix());
        EXPECT_EQ(a.increment.covariance, b.increment.covariance);
        EXPECT_EQ(a.features->pattern.directions, b.features->pattern.directions);
        EXPECT_EQ(a.features->pattern.weights, b.features->pattern.weights);
        EXPECT_EQ(a.features->lines.midpoints, b.features->lines.midpoints);
        EXPECT_EQ(a.registration.rotation.residual_rad, b.registration.rotation.residual_rad);
        EXPECT_EQ(a.registration.translation.residual_m, b.registration.translation.residual_m);
        EXPECT_EQ(a.registration.rotation.observability, b.registration.rotation.observability);
        EXPECT_EQ(a.registration.translation.matches, b.registration.translation.matches);
    }
    EXPECT_GT(one[1].increment.pose.norm(), 0.1);
}
}  // namespace
