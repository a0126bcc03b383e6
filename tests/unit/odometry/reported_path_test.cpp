#include "odometry/reported_path.h"

#include <gtest/gtest.h>

using namespace delio;
using namespace delio::odometry;

namespace {
Eigen::Isometry3d at(double x) { return Eigen::Isometry3d(Eigen::Translation3d(x, 0, 0)); }

/** Reports the next scan of a sensor at `pose`. */
Step advance(ReportedPath& path, const Eigen::Isometry3d& pose, double time_s) {
    Step step;
    const Eigen::Isometry3d before = path.latest().pose;
    step.increment.pose = path.advance({pose, 0, time_s}, before);
    path.report(step);
    return step;
}
}  // namespace

TEST(ReportedPath, ScansThatMovedAreCorrectedAndTheOneBeforeThem) {
    ReportedPath path;
    for (const double time_s : {0.0, 0.1, 0.2, 0.3}) advance(path, at(0), time_s);
    // The latest three of five scans move on by 1 m each.
    std::vector<MovingScan> moved;
    for (const double time_s : {0.2, 0.3, 0.4}) {
        MovingScan scan;
        scan.time_s = time_s;
        const Twist motion{{10, 0, 0}, Eigen::Vector3d::Zero()};
        scan.trajectory = placed(at(10 * (time_s - 0.4)), ScanTrajectory(motion));
        moved.push_back(scan);
    }
    path.correct(moved);
    const Step step = advance(path, at(0), 0.4);
    // The scan before was reported where the sensor seemed to stand.
    EXPECT_NEAR(step.increment.pose.translation().x(), 3, 1e-9);
    ASSERT_EQ(step.corrected.size(), 3);
    for (std::size_t i = 0; i < 3; ++i) {
        const auto& corrected = step.corrected[i];
        EXPECT_EQ(corrected.scansAgo, 3 - i);
        EXPECT_EQ(corrected.registered, i > 0) << "the scan before them only moves along";
        EXPECT_NEAR(corrected.pose.translation().x(), -static_cast<double>(3 - i), 1e-9);
    }
}

TEST(ReportedPath, AStampThatTheNextScanPassesIsCorrectedAlone) {
    ReportedPath path;
    for (const double time_s : {0.0, 0.1, 0.2}) advance(path, at(10 * time_s), time_s);
    path.correctStamp(at(1.9));
    const Step step = advance(path, at(3), 0.3);
    EXPECT_NEAR(step.increment.pose.translation().x(), 1, 1e-9) << "from where it was said to be";
    ASSERT_EQ(step.corrected.size(), 1);
    EXPECT_EQ(step.corrected[0].scansAgo, 1);
    EXPECT_TRUE(step.corrected[0].staysInPlace);
    EXPECT_NEAR(step.corrected[0].pose.translation().x(), -1.1, 1e-9);
    EXPECT_TRUE(advance(path, at(4), 0.4).corrected.empty());
}
