#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "delio/evaluation/comparison.h"
#include "delio/evaluation/metrics.h"
#include "delio/formats/trajectory.h"
#include "test_data.h"

namespace {
using namespace delio;

struct Expected {
    std::string sequence, method;
    double length_m, t_percent, r_deg_per_100m;
    std::size_t segments;
};

/** The published figures: one for every sequence and method that has them. */
std::vector<Expected> expectedFigures() {
    std::istringstream table(test::readText(test::dataFolder() / "evaluator/expected.tsv"));
    std::vector<Expected> figures;
    std::string line;
    std::getline(table, line);  // heading
    while (std::getline(table, line)) {
        std::istringstream cells(line);
        Expected figure;
        cells >> figure.sequence >> figure.length_m >> figure.segments;
        for (const char* method : {"offline", "online"}) {
            std::string t, r;
            cells >> t >> r;
            if (t == "-") continue;
            figure.method = method;
            figure.t_percent = std::stod(t);
            figure.r_deg_per_100m = std::stod(r);
            figures.push_back(figure);
        }
    }
    return figures;
}

TEST(Evaluator, GivesThePublishedFiguresOfEverySequence) {
    DELIO_NEED_DATA("evaluator/expected.tsv");
    const auto figures = expectedFigures();
    EXPECT_EQ(figures.size(), 14U);
    double worstTranslation = 0, worstRotation = 0;
    for (const auto& expected : figures) {
        SCOPED_TRACE(expected.method + " " + expected.sequence);
        const std::string file = expected.sequence + ".txt";
        const auto truth = io::readTrajectory(test::dataFolder() / "kitti/poses" / file).poses;
        const auto estimate =
            io::readTrajectory(test::dataFolder() / "evaluator" / expected.method / file).poses;
        const auto found = evaluation::kittiErrors(truth, estimate);
        EXPECT_EQ(found.segments, expected.segments);
        EXPECT_NEAR(found.t_percent, expected.t_percent, 2e-5);
        EXPECT_NEAR(found.r_deg_per_100m, expected.r_deg_per_100m, 2e-4);
        EXPECT_NEAR(evaluation::pathLength_m(truth), expected.length_m, 0.0501);
        worstTranslation =
            std::max(worstTranslation, std::abs(found.t_percent - expected.t_percent));
        worstRotation =
            std::max(worstRotation, std::abs(found.r_deg_per_100m - expected.r_deg_per_100m));
    }
    RecordProperty("worst_translation_percent", std::to_string(worstTranslation));
    RecordProperty("worst_rotation_deg_per_100m", std::to_string(worstRotation));
}

TEST(Evaluator, WarnsOfTheHeadOf00AndOfNothingElse) {
    DELIO_NEED_DATA("evaluator/expected.tsv");
    for (const auto& expected : expectedFigures()) {
        SCOPED_TRACE(expected.method + " " + expected.sequence);
        const std::string file = expected.sequence + ".txt";
        auto truth = io::readTrajectory(test::dataFolder() / "kitti/poses" / file);
        auto estimate =
            io::readTrajectory(test::dataFolder() / "evaluator" / expected.method / file);
        EXPECT_EQ(evaluation::compare(truth, estimate, {}).referenceFault, "");
        for (auto* trajectory : {&truth, &estimate}) trajectory->poses.resize(10);
        EXPECT_EQ(evaluation::compare(truth, estimate, {}).referenceFault.empty(),
                  expected.sequence != "00");
    }
}

TEST(Evaluator, SeesTheWrongFrameOnEverySequence) {
    DELIO_NEED_DATA("evaluator/expected.tsv");
    DELIO_NEED_DATA("kitti/00_first16/calib.txt");
    const auto Tr = io::readCalibration(test::dataFolder() / "kitti/00_first16/calib.txt").Tr;
    for (const auto& expected : expectedFigures()) {
        SCOPED_TRACE(expected.method + " " + expected.sequence);
        const std::string file = expected.sequence + ".txt";
        const auto truth = io::readTrajectory(test::dataFolder() / "kitti/poses" / file);
        const auto estimate =
            io::readTrajectory(test::dataFolder() / "evaluator" / expected.method / file);
        using evaluation::findFrameMismatch, evaluation::FrameMismatch;
        EXPECT_EQ(findFrameMismatch(truth.poses, estimate.poses), FrameMismatch::none);
        const auto lidar = io::lidarToCam0(estimate, Tr.inverse());  // the reverse of its name
        EXPECT_EQ(findFrameMismatch(truth.poses, lidar.poses), FrameMismatch::lidarAgainstCamera);
        const auto twice = io::lidarToCam0(estimate, Tr);
        EXPECT_EQ(findFrameMismatch(truth.poses, twice.poses), FrameMismatch::cameraAgainstLidar);
    }
}
}  // namespace
