#include <gtest/gtest.h>

#include <vector>

#include "delio/slam/options.h"
#include "odometry/pipeline.h"
#include "poses.h"
#include "swing.h"

using namespace delio;

namespace {
using Eigen::Isometry3d;

constexpr std::size_t kScans = 12, kCorrected = 8;  // the latter by the last of these

double timeOf(std::size_t i) { return 0.1 * static_cast<double>(i); }

/** Flies at 8 m/s and nods by 6 deg. */
struct Flight {
    double phase_s = 0;  //!< of the nodding

    Isometry3d at(double time_s) const {
        const double nod = 6 * M_PI / 180 * std::sin(2 * M_PI * 0.7 * (time_s + phase_s));
        return isometry(rotationExp(Eigen::Vector3d(nod / 2, nod, 0)),
                        Eigen::Vector3d(8 * time_s - 2, 0, 0.2 * std::sin(2 * time_s)));
    }
    Scan scan(std::size_t i) const {
        const auto sweep = test::sweep(test::yard(), 0.01, timeOf(i),
                                       [this](double time_s) { return at(time_s); });
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

// The first scans of a drive have few others to be registered to, and a motion that is not known.
// The eighth scan corrects them.
TEST(PlaneOdometry, CorrectsTheFirstScansOnceMoreHaveFollowed) {
    double before_m = 0, after_m = 0;
    for (const double phase_s : {0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9, 1.05, 1.2, 1.35}) {
        const Flight flight{phase_s};
        odometry::PlaneOdometry odometry(Options::ofProfile("accurate").planes);
        std::vector<Isometry3d> asItCame, poses;
        for (std::size_t i = 0; i < kScans; ++i) {
            const Step step = odometry.process(flight.scan(i));
            poses.push_back(i == 0 ? Isometry3d::Identity() : poses.back() * step.increment.pose);
            for (const auto& [scansAgo, pose, registered] : step.corrected) {
                ASSERT_LE(scansAgo, i);
                poses[i - scansAgo] = poses[i] * pose;
            }
            EXPECT_EQ(step.corrected.empty(), i + 1 != kCorrected) << i;
            if (i + 1 < kCorrected) asItCame = poses;
        }
        EXPECT_LT(test::metresBetween(poses[0], Isometry3d::Identity()), 1e-9);
        before_m += flight.errorOf(asItCame);
        after_m += flight.errorOf({poses.begin(), poses.begin() + kCorrected - 1});
        EXPECT_LT(flight.errorOf(poses), 0.03) << phase_s;
    }
    EXPECT_LT(after_m, 0.65 * before_m);
}
}  // namespace
