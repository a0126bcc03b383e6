#include "delio/run/run_rows.h"

#include <gtest/gtest.h>

#include <vector>

namespace {
using namespace delio;

run::RunRow someRow() {
    run::RunRow row;
    row.scan = 7;
    row.stamp_s = 0.1 + 0.2;
    row.sensorPose.translation() << 1, 2, 3;
    row.points = 4;
    row.read_ms = 5.5;
    Step& step = row.report.step;
    step.predicted = step.searched = step.interrupted = step.standing = step.deskewed = true;
    step.reason = "not found in the map";
    step.quality.matches = 8;
    step.quality.residual_m = 0.3;
    step.quality.rotationObservability << 1, 2, 3;
    step.quality.translationObservability << 4, 5, 6;
    step.quality.unobservedRotation = Eigen::Matrix3d::Identity();
    step.quality.unobservedTranslation = Eigen::Vector3d::UnitY();
    step.notFinite = 10;
    step.times_ms = {{"a stage with a name that is long", 1.5}, {"planes", 2}};
    step.details = {{"scale", 0.25}};
    row.report.listeners_ms = {{"graph", 3}};
    return row;
}

/** All but what is not kept. */
void expectSame(const run::RunRow& row, const run::RunRow& expected) {
    const Step &step = row.report.step, &other = expected.report.step;
    EXPECT_EQ(row.scan, expected.scan);
    EXPECT_EQ(row.stamp_s, expected.stamp_s);
    EXPECT_EQ(row.sensorPose.matrix(), expected.sensorPose.matrix());
    EXPECT_EQ(row.points, expected.points);
    EXPECT_EQ(row.read_ms, expected.read_ms);
    EXPECT_EQ(row.report.listeners_ms, expected.report.listeners_ms);
    EXPECT_EQ(step.predicted, other.predicted);
    EXPECT_EQ(step.searched, other.searched);
    EXPECT_EQ(step.interrupted, other.interrupted);
    EXPECT_EQ(step.standing, other.standing);
    EXPECT_EQ(step.deskewed, other.deskewed);
    EXPECT_EQ(step.reason, other.reason);
    EXPECT_EQ(step.quality.matches, other.quality.matches);
    EXPECT_EQ(step.quality.residual_m, other.quality.residual_m);
    EXPECT_EQ(step.quality.rotationObservability, other.quality.rotationObservability);
    EXPECT_EQ(step.quality.translationObservability, other.quality.translationObservability);
    EXPECT_EQ(step.quality.unobservedRotation, other.quality.unobservedRotation);
    EXPECT_EQ(step.quality.unobservedTranslation, other.quality.unobservedTranslation);
    EXPECT_EQ(step.notFinite, other.notFinite);
    EXPECT_EQ(step.times_ms, other.times_ms);
    EXPECT_EQ(step.details, other.details);
}

TEST(RunRows, ComeBackAsTheyWerePutIn) {
    run::RunRow second;
    second.scan = std::size_t{1} << 40;
    second.report.step.details = {{"another", -0.0}, {"name", 1e-300}};
    const std::vector<run::RunRow> put{someRow(), second, someRow()};
    run::RunRows rows;
    for (const auto& row : put) rows.push_back(row);
    ASSERT_EQ(rows.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) expectSame(rows[i], put[i]);
    std::size_t i = 0;
    for (const auto& row : rows) EXPECT_EQ(row.scan, put[i++].scan);
    EXPECT_EQ(i, 3U);
}

TEST(RunRows, OfASensorThatTurnsOnItsVehicle) {
    run::RunRows rows;
    std::vector<run::RunRow> put;
    for (int i = 0; i < 300; ++i) {
        put.push_back(someRow());
        put.back().sensorPose.translation().x() = i % 200;
        rows.push_back(put.back());
    }
    for (std::size_t i = 0; i < put.size(); ++i) expectSame(rows[i], put[i]);
}
}  // namespace
