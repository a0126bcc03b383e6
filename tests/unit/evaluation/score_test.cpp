#include "delio/evaluation/score.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {
using namespace delio::evaluation;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

ReportRow row(const std::string& sequence, double length_m, std::size_t segments, double t) {
    ReportRow result;
    result.name = "x";
    result.sequence = sequence;
    result.length_m = length_m;
    result.kitti.segments = segments;
    result.kitti.t_percent = t;
    result.kitti.r_deg_per_100m = t / 4;
    return result;
}

TEST(Score, TheAverageIsThePlainMeanOfTheSequences) {
    const auto average = averageOf({row("00", 4000, 3000, 1), row("04", 400, 40, 2)});
    EXPECT_EQ(average.name, "x");
    EXPECT_EQ(average.sequence, "avg");
    EXPECT_DOUBLE_EQ(average.length_m, 4400);
    EXPECT_EQ(average.kitti.segments, 3040U);
    EXPECT_DOUBLE_EQ(average.kitti.t_percent, 1.5);
    EXPECT_DOUBLE_EQ(average.kitti.r_deg_per_100m, 0.375);
}

TEST(Score, AFigureThatIsNotThereIsLeftOutOfTheAverage) {
    EXPECT_DOUBLE_EQ(averageOf({row("00", 40, 0, kNone), row("04", 400, 40, 2)}).kitti.t_percent,
                     2);
    EXPECT_TRUE(std::isnan(averageOf({row("00", 40, 0, kNone)}).kitti.t_percent));
}
}  // namespace
