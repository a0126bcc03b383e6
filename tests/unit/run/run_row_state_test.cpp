#include <gtest/gtest.h>

#include <sstream>

#include "core/checkpoint.h"
#include "delio/run/run_record.h"

namespace {
using namespace delio;

TEST(RunRowState, ComesBackAsItWas) {
    run::RunRow row;
    row.scan = 7;
    row.stamp_s = 0.1 + 0.2;
    row.sensorPose.translation() << 1, 2, 3;
    row.points = 4;
    row.read_ms = 5.5;
    Step& step = row.report.step;
    step.increment.pose.translation() << 0.1, -0.0, 1e-300;
    step.increment.covariance(2, 3) = 6;
    step.predicted = step.searched = step.interrupted = step.deskewed = true;
    step.reason = "not found in the map";
    step.quality.matches = 8;
    step.quality.residual_m = 0.3;
    step.quality.rotationObservability << 1, 2, 3;
    step.quality.translationObservability << 4, 5, 6;
    step.quality.unobservedRotation = Eigen::Matrix3d::Identity();
    step.quality.unobservedTranslation = Eigen::Vector3d::UnitY();
    step.used.points = Eigen::Matrix3Xf::Ones(3, 2);
    step.used.indices = {3, 9};
    step.used.dynamic = {0, 1};
    step.notFinite = 10;
    step.times_ms = {{"a stage with a name that is long", 1.5}, {"planes", 2}};
    step.details = {{"scale", 0.25}};
    row.report.listeners_ms = {{"graph", 3}};

    std::ostringstream bytes;
    checkpoint::save(bytes, {"row", ""}, row);
    run::RunRow again;
    std::istringstream in(bytes.str());
    checkpoint::restore(in, {"row", ""}, again);
    const Step& other = again.report.step;
    EXPECT_EQ(again.scan, row.scan);
    EXPECT_EQ(again.stamp_s, row.stamp_s);
    EXPECT_EQ(again.sensorPose.matrix(), row.sensorPose.matrix());
    EXPECT_EQ(again.points, row.points);
    EXPECT_EQ(again.read_ms, row.read_ms);
    EXPECT_EQ(again.report.listeners_ms, row.report.listeners_ms);
    EXPECT_EQ(other.increment.pose.matrix(), step.increment.pose.matrix());
    EXPECT_EQ(other.increment.covariance, step.increment.covariance);
    EXPECT_TRUE(other.predicted && other.searched && other.interrupted && other.deskewed);
    EXPECT_EQ(other.reason, step.reason);
    EXPECT_EQ(other.quality.matches, step.quality.matches);
    EXPECT_EQ(other.quality.residual_m, step.quality.residual_m);
    EXPECT_EQ(other.quality.rotationObservability, step.quality.rotationObservability);
    EXPECT_EQ(other.quality.translationObservability, step.quality.translationObservability);
    EXPECT_EQ(other.quality.unobservedRotation, step.quality.unobservedRotation);
    EXPECT_EQ(other.quality.unobservedTranslation, step.quality.unobservedTranslation);
    EXPECT_EQ(other.used.points, step.used.points);
    EXPECT_EQ(other.used.indices, step.used.indices);
    EXPECT_EQ(other.used.dynamic, step.used.dynamic);
    EXPECT_EQ(other.notFinite, step.notFinite);
    EXPECT_EQ(other.times_ms, step.times_ms);
    EXPECT_EQ(other.details, step.details);
}
}  // namespace
