#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "delio/slam/options.h"
#include "odometry/pipeline.h"
#include "poses.h"
#include "swing.h"

using namespace delio;

namespace {
using Eigen::Isometry3d;

double timeOf(std::size_t i) { return 0.1 * static_cast<double>(i); }

/** A sensor that moves through the yard. */
struct Flight {
    std::function<Isometry3d(double)> at;  //!< pose at a time, seconds

    Scan scan(std::size_t i) const {
        const auto sweep = test::sweep(test::yard(), 0.01, timeOf(i), at);
        Scan scan = test::scanOf(sweep.points.cast<float>());
        scan.times_s.assign(sweep.times_s.begin(), sweep.times_s.end());
        scan.stamp_s = timeOf(i);
        return scan;
    }
    /** Error (metres) of where the first scan lies, seen from the last of `poses`. */
    double errorOf(const std::vector<Isometry3d>& poses) const {
        const double last_s = timeOf(poses.size() - 1);
        return test::metresBetween(poses.back().inverse() * poses.front(),
                                   at(last_s).inverse() * at(0));
    }
};

/** 8 m/s, nodding by 6 deg. */
Flight nodding(double phase_s) {
    return {[phase_s](double time_s) {
        const double nod = 6 * M_PI / 180 * std::sin(2 * M_PI * 0.7 * (time_s + phase_s));
        return isometry(rotationExp(Eigen::Vector3d(nod / 2, nod, 0)),
                        Eigen::Vector3d(8 * time_s - 2, 0, 0.2 * std::sin(2 * time_s)));
    }};
}

Flight inTheHand(double phase_s) {
    return {[phase_s](double time_s) { return test::swung(time_s + phase_s); }};
}

/** Rates of a gyroscope with the LiDAR's axes, during scan i and before it. */
void addSamples(const Flight& flight, std::size_t i, odometry::PlaneOdometry& odometry) {
    constexpr double kInterval_s = 0.005, kHalf_s = 1e-4;
    for (int k = -10; k < 10; ++k) {
        ImuSample sample;
        sample.stamp_s = timeOf(i) + (k + 0.5) * kInterval_s;
        sample.rate_radps = rotationLog(flight.at(sample.stamp_s - kHalf_s).linear().transpose() *
                                        flight.at(sample.stamp_s + kHalf_s).linear()) /
                            (2 * kHalf_s);
        sample.sensorPose = Isometry3d::Identity();
        odometry.addImu(sample);
    }
}

struct Flown {
    std::vector<Isometry3d> poses;         //!< at the end
    std::vector<Isometry3d> asItCame;      //!< of the scans before the first that corrects others
    std::vector<std::size_t> correctedBy;  //!< scans that corrected others
};

Flown fly(const Flight& flight, std::size_t scans, bool withGyro, bool settles = false) {
    odometry::PlaneOdometry odometry(Options::ofProfile("accurate").planes);
    Flown flown;
    auto& poses = flown.poses;
    for (std::size_t i = 0; i < scans; ++i) {
        if (withGyro) addSamples(flight, i, odometry);
        const Step step = odometry.process(flight.scan(i));
        if (settles) odometry.settle();
        if (flown.correctedBy.empty()) flown.asItCame = poses;
        if (!step.corrected.empty()) flown.correctedBy.push_back(i);
        poses.push_back(i == 0 ? Isometry3d::Identity() : poses.back() * step.increment.pose);
        for (const auto& [scansAgo, pose, registered, inPlace] : step.corrected)
            poses.at(i - scansAgo) = poses[i] * pose;
    }
    return flown;
}

// The first scans of a drive have few others to be registered to, and a motion that is not known.
// They are registered again after the eighth one, and the ninth one corrects them.
TEST(PlaneOdometry, CorrectsTheFirstScansOnceMoreHaveFollowed) {
    double before_m = 0, after_m = 0;
    for (const double phase_s : {0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9, 1.05, 1.2, 1.35}) {
        const Flight flight = nodding(phase_s);
        const Flown flown = fly(flight, 12, false);
        EXPECT_EQ(flown.correctedBy, std::vector<std::size_t>{8});
        EXPECT_LT(test::metresBetween(flown.poses[0], Isometry3d::Identity()), 1e-9);
        before_m += flight.errorOf(flown.asItCame);
        after_m += flight.errorOf({flown.poses.begin(), flown.poses.begin() + 8});
        EXPECT_LT(flight.errorOf(flown.poses), 0.03) << phase_s;
    }
    EXPECT_LT(after_m, 0.65 * before_m);
}

// A gyroscope is trusted only after some scans. The fifteenth scan corrects those before.
TEST(PlaneOdometry, CorrectsTheFirstScansByTheGyroscope) {
    for (const double phase_s : {0.0, 0.3}) {
        const Flight flight = inTheHand(phase_s);
        const Flown flown = fly(flight, 16, true);
        EXPECT_EQ(flown.correctedBy.back(), 14U);
        EXPECT_LT(flight.errorOf(flown.poses), 0.01) << phase_s;
    }
}

// Samples of the gyroscope come after settle() or before the same work is done in process().
TEST(PlaneOdometry, SettlingChangesNothingWhereTheFirstScansAreRegisteredAgain) {
    const Flight flight = inTheHand(0);
    const Flown once = fly(flight, 16, true), settled = fly(flight, 16, true, true);
    ASSERT_EQ(settled.correctedBy, once.correctedBy);
    for (std::size_t i = 0; i < once.poses.size(); ++i)
        EXPECT_EQ(settled.poses[i].matrix(), once.poses[i].matrix()) << i;
}
}  // namespace
