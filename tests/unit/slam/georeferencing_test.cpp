#include "slam/georeferencing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "delio/core/geometry.h"

namespace {
using namespace delio;
using Eigen::Isometry3d;
using Eigen::Vector3d;

/** A drive of steps of a metre with drifting odometry, a true place on the earth, and fixes. */
struct Drive {
    std::vector<Isometry3d> truth;  //!< in the map's frame
    graph::PoseGraph graph;         //!< of the odometry
    earth::Track track;
    earth::Georeference place;
    Vector3d lever{-0.8, 0.3, 0.5};
    earth::Fixes fixes;

    /** `turn`: rad per step, of the first half; the second half turns the other way. */
    Drive(std::size_t count, double turn, double drift_rad, std::uint32_t seed = 1) {
        std::mt19937 random(seed);
        std::normal_distribution<double> normal;
        place.origin = {49.011, 8.4228, 112.8};
        place.enuFromMap = isometry(rotationExp({0.02, -0.03, 2.1}), Vector3d::Zero());
        Isometry3d pose = Isometry3d::Identity(), estimate = pose;
        for (std::size_t i = 0; i < count; ++i) {
            truth.push_back(pose);
            track.poses.push_back(estimate);
            track.stamps_s.push_back(0.1 * static_cast<double>(i));
            const double yaw = i < count / 2 ? turn : -turn;
            const Isometry3d step = isometry(rotationExp({0, 0, yaw}), Vector3d(1, 0, 0));
            const Isometry3d noise = isometry(
                rotationExp(Vector3d(drift_rad * normal(random), drift_rad * normal(random),
                                     drift_rad * normal(random))),
                0.005 * Vector3d(normal(random), normal(random), normal(random)));
            graph.addNode(estimate);
            if (i > 0) {
                Matrix6 covariance = Matrix6::Identity() * 0.005 * 0.005;
                covariance.bottomRightCorner<3, 3>() *=
                    std::pow(std::max(drift_rad, 1e-5) / 0.005, 2);
                graph.addEdge(
                    {i - 1, i, {track.poses[i - 1].inverse() * track.poses[i], covariance}});
            }
            pose = pose * step;
            estimate = estimate * step * noise;
        }
        track.usable.assign(count, true);
    }

    static Isometry3d between(const std::vector<Isometry3d>& poses, double stamp_s) {
        const auto i = static_cast<std::size_t>(stamp_s * 10);
        const double part = stamp_s * 10 - static_cast<double>(i);
        const Isometry3d step = poses[i].inverse() * poses[i + 1];
        return poses[i] * isometry(rotationExp(Vector3d(part * rotationLog(step.linear()))),
                                   Vector3d(part * step.translation()));
    }

    /** Fixes every 0.5 s; `wrong` of a hundred are 20 m off. */
    void measure(double sigma, std::size_t wrong = 0, std::uint32_t seed = 2) {
        std::mt19937 random(seed);
        std::normal_distribution<double> normal;
        for (double stamp = 0.013; stamp < track.stamps_s.back(); stamp += 0.5) {
            earth::Fix fix;
            fix.stamp_s = stamp;
            fix.antenna = lever;
            const Vector3d enu = place.enuFromMap * (between(truth, stamp) * lever);
            Vector3d noise(normal(random), normal(random), 2 * normal(random));
            noise *= sigma;
            if (random() % 100 < wrong) noise.x() += 20;
            fix.place = earth::EnuFrame(place.origin).geodeticOf(enu + noise);
            fix.covariance = Vector3d(1, 1, 4).asDiagonal();
            fix.covariance *= sigma * sigma;
            fixes.push_back(fix);
        }
    }

    Georeferenced find(bool inGraph = true) const {
        const graph::PoseGraphOptions options;
        return georeferenced(graph, track, fixes, inGraph ? &options : nullptr);
    }

    /** Root mean square distance of the poses on the earth from the true ones, metres. */
    double errorOf(const Georeferenced& found) const {
        const earth::EnuFrame enu(place.origin);
        double sum = 0;
        for (std::size_t i = 0; i < truth.size(); ++i) {
            const auto there = found.place.geodeticOf(found.graph.poses()[i].translation());
            sum += (enu.enuOf(there) - place.enuFromMap * truth[i].translation()).squaredNorm();
        }
        return std::sqrt(sum / static_cast<double>(truth.size()));
    }
};

double angleBetween(const Isometry3d& a, const Isometry3d& b) {
    return rotationLog(a.linear().transpose() * b.linear()).norm() * 180 / M_PI;
}

TEST(Georeferencing, FindsWhereTheMapLies) {
    Drive drive(300, 0.01, 0);
    drive.measure(0.02);
    const auto found = drive.find(false);
    ASSERT_EQ(found.figures.refusal, "");
    EXPECT_EQ(found.figures.inGraph, 0U);
    EXPECT_EQ(found.figures.rejected, 0U);
    EXPECT_LT(angleBetween(found.place.enuFromMap, drive.place.enuFromMap), 0.1);
    EXPECT_NEAR(found.place.origin.latitude_deg, drive.place.origin.latitude_deg, 2e-6);
    EXPECT_LT(drive.errorOf(found), 0.15);
    EXPECT_TRUE(found.place.enuFromMap.translation().isZero());
    // The same bytes once more.
    EXPECT_TRUE(drive.find(false).place.enuFromMap.matrix() == found.place.enuFromMap.matrix());
}

TEST(Georeferencing, BelievesItsCovariance) {
    double sum = 0, sumHeading = 0;
    constexpr int kDrives = 40;
    for (std::uint32_t seed = 0; seed < kDrives; ++seed) {
        Drive drive(200, 0.01, 0);
        drive.measure(0.5, 0, 100 + seed);
        const auto found = drive.find(false);
        ASSERT_EQ(found.figures.refusal, "");
        const double heading =
            std::remainder(found.figures.heading_deg - earth::heading_deg(drive.place.enuFromMap),
                           360) /
            found.figures.headingSigma_deg;
        const Vector3d origin = earth::EnuFrame(drive.place.origin).enuOf(found.place.origin);
        sum += origin.head<2>().cwiseQuotient(found.figures.originSigma_m.head<2>()).squaredNorm();
        sumHeading += heading * heading;
    }
    EXPECT_LT(sum / (2 * kDrives), 2);
    EXPECT_GT(sum / (2 * kDrives), 0.3);
    EXPECT_LT(sumHeading / kDrives, 2);
    EXPECT_GT(sumHeading / kDrives, 0.3);
}

TEST(Georeferencing, TakesTheDriftOutOfTheDrive) {
    Drive drive(2000, 0.004, 0.0005);
    drive.measure(0.02);
    const double before = drive.errorOf(drive.find(false));
    const auto found = drive.find();
    ASSERT_EQ(found.figures.refusal, "");
    EXPECT_GT(found.figures.inGraph, drive.fixes.size() / 2);
    EXPECT_GT(before, 0.5);
    EXPECT_LT(drive.errorOf(found), 0.05);
    EXPECT_LT(found.figures.rejected, drive.fixes.size() / 50);
    // The map's frame is that of the first pose, as it was.
    EXPECT_TRUE(found.graph.poses()[0].matrix() == drive.graph.poses()[0].matrix());
    EXPECT_EQ(found.graph.edges().size(), drive.graph.edges().size());
}

TEST(Georeferencing, LeavesOutWrongFixes) {
    for (const double sigma : {0.02, 2.0}) {
        Drive good(1500, 0.004, 0.0003), bad = good;
        good.measure(sigma);
        bad.measure(sigma, 10);
        const auto found = bad.find();
        ASSERT_EQ(found.figures.refusal, "");
        EXPECT_LT(bad.errorOf(found), 1.1 * good.errorOf(good.find()) + 0.005) << sigma;
        EXPECT_GT(found.figures.rejected, bad.fixes.size() / 20);
        EXPECT_LT(found.figures.rejected, bad.fixes.size() / 5);
    }
}

TEST(Georeferencing, OfAStraightTrackIsGood) {
    Drive drive(200, 0, 0);
    drive.measure(0.02);
    const auto found = drive.find();
    ASSERT_EQ(found.figures.refusal, "");
    EXPECT_NEAR(found.figures.heading_deg, earth::heading_deg(drive.place.enuFromMap), 0.1);
}

TEST(Georeferencing, RefusesWhatDoesNotSay) {
    const auto refusal = [](Drive& drive) { return drive.find().figures.refusal; };
    const auto expect = [&](Drive drive, const std::string& words) {
        const auto why = refusal(drive);
        EXPECT_NE(why.find(words), why.npos) << why;
    };
    Drive drive(300, 0.01, 0);
    expect(drive, "none of the 0");
    drive.measure(0.02);
    Drive one = drive;
    one.fixes.resize(1);
    expect(one, "only 1 GNSS");
    Drive equal = drive;
    for (auto& fix : equal.fixes) fix.place = drive.fixes[0].place;
    expect(equal, "stay at one place");
    Drive zero = drive;
    for (auto& fix : zero.fixes) fix.place = {0, 0, 0};
    expect(zero, "is usable");
    Drive nowhere = drive;
    for (auto& fix : nowhere.fixes) fix.place.latitude_deg = std::nan("");
    expect(nowhere, "is usable");
    Drive clock = drive;
    for (auto& fix : clock.fixes) fix.stamp_s += 1.7e9;
    expect(clock, "another clock");
    Drive shortDrive(6, 0, 0);
    shortDrive.measure(3);
    for (int i = 0; i < 20; ++i) shortDrive.fixes.push_back(shortDrive.fixes.front());
    expect(shortDrive, "too short");
    Drive noise = drive;
    std::mt19937 random(1);
    for (auto& fix : noise.fixes)
        fix.place.latitude_deg += 1e-5 * static_cast<double>(random() % 1000);
    EXPECT_NE(refusal(noise), "");
}

TEST(Georeferencing, KeepsToTheTimesItKnows) {
    Drive drive(300, 0.01, 0);
    drive.measure(0.02);
    auto found = earth::fixesOn(drive.track, drive.fixes);
    EXPECT_EQ(found.size(), drive.fixes.size());
    // The antenna is where it was at the time of the fix, not at the scan's.
    const Vector3d inMap = drive.track.poses[found[7].node] * found[7].antenna;
    const Vector3d then = Drive::between(drive.track.poses, found[7].fix.stamp_s) * drive.lever;
    EXPECT_LT((inMap - then).norm(), 1e-9);
    // Times of the day, where the drive has Unix times.
    Drive day = drive;
    for (auto& stamp : day.track.stamps_s) stamp += 1.7e9 + 1000;
    for (auto& fix : day.fixes) fix.stamp_s += std::fmod(1.7e9 + 1000, 86400);
    EXPECT_EQ(day.find(false).figures.refusal, "");
    // No fix is used within a gap, or beside a predicted pose.
    drive.track.usable[100] = false;
    for (std::size_t i = 200; i < 300; ++i) drive.track.stamps_s[i] += 2;
    found = earth::fixesOn(drive.track, drive.fixes);
    for (const auto& each : found) {
        EXPECT_FALSE(each.fix.stamp_s > 9.9 && each.fix.stamp_s < 10.1);
        EXPECT_FALSE(each.fix.stamp_s > 19.9 && each.fix.stamp_s < 22);
    }
}

TEST(Georeferencing, WorksWithoutHeights) {
    Drive drive(600, 0.008, 0);
    drive.measure(0.02);
    for (auto& fix : drive.fixes) {
        fix.place.height_m = 0;
        fix.covariance(2, 2) = 1e6;
    }
    const auto found = drive.find();
    ASSERT_EQ(found.figures.refusal, "");
    EXPECT_NEAR(found.figures.heading_deg, earth::heading_deg(drive.place.enuFromMap), 0.3);
}
}  // namespace
