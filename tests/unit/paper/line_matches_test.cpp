#include "paper/line_registration.h"

#include <gtest/gtest.h>

#include "ring_scan.h"

namespace {
using namespace delio;
using paper::LineCloud;
using paper::LineMatcher;

/** Midpoints of lines of a scan taken at a place in a room, in the room's axes; with other lines
 *  for each place, as odometry draws them. */
LineCloud linesAt(double x, double y) {
    LineCloudOptions options;
    options.seed = static_cast<std::uint32_t>(1e4 + 1e3 * (x + y));
    test::Noise noise;
    const auto pose = test::poseAt(x, y, 0, 0.4);
    const auto scan = test::ringScan(test::room(), pose, {40, 540, -24, 14, 0}, noise);
    return paper::rotated(paper::drawLines(scan.points, scan.rings, options), pose.linear());
}

TEST(LineMatcher, FindsWhatASearchOfAllFindsHoweverFarLinesMove) {
    const LineCloud from = linesAt(0, 0), to = linesAt(1, 0), others = linesAt(0, 2);
    LineMatcher matcher(from);
    for (const double moved : {0.0, 0.001, 0.002, 0.01, 0.05, 0.3, 0.31, 2.0, 0.0})
        for (const LineCloud* lines : {&to, &others}) {
            const Eigen::Vector3d t(moved, -moved / 2, 0.1 * moved);
            const auto matches = matcher.matches(*lines, t, 0.5);
            ASSERT_EQ(matches.size(), static_cast<std::size_t>(lines->midpoints.cols()));
            for (std::size_t i = 0; i < matches.size(); ++i) {
                const Eigen::Vector3f at =
                    lines->midpoints.col(static_cast<Eigen::Index>(i)) + t.cast<float>();
                const float nearest = (from.midpoints.colwise() - at).colwise().norm().minCoeff();
                if (nearest > 0.5F)
                    EXPECT_LT(matches[i].distance, 0) << moved;
                else
                    EXPECT_NEAR(matches[i].distance, nearest, 1e-5F) << moved;
            }
        }
}

TEST(LineMatcher, OfNoLinesThereIsNoMatch) {
    const LineCloud none, some = linesAt(0, 0);
    EXPECT_LT(LineMatcher(none).matches(some, {0, 0, 0}, 5).front().distance, 0);
    EXPECT_TRUE(LineMatcher(some).matches(none, {0, 0, 0}, 5).empty());
}
}  // namespace
