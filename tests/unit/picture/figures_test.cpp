#include "delio/picture/figures.h"

#include <gtest/gtest.h>
#include <mrpt/img/CImage.h>

#include <cmath>

#include "delio/picture/render.h"
#include "ring_scan.h"

namespace {
using namespace delio;

/** Pixels in which one channel stands out from the two others, by third of the picture. */
std::vector<int> colouredByThird(const mrpt::img::CImage& picture) {
    std::vector<int> count(3, 0);
    for (unsigned y = 0; y < picture.getHeight(); ++y)
        for (unsigned x = 0; x < picture.getWidth(); ++x) {
            const int r = picture.at<uint8_t>(x, y, 0), g = picture.at<uint8_t>(x, y, 1),
                      b = picture.at<uint8_t>(x, y, 2);
            const int spread = std::max({r, g, b}) - std::min({r, g, b});
            count[std::size_t{3} * x / picture.getWidth()] += spread > 40;
        }
    return count;
}

TEST(FiguresScene, PatternsStandSideBySideOnTheirSpheres) {
    test::Noise noise;
    // Seen by who looks along +x: normals that look back at the viewer.
    Eigen::Matrix3Xf many(3, 400), few(3, 40), none(3, 0);
    for (auto* pattern : {&many, &few})
        for (Eigen::Index i = 0; i < pattern->cols(); ++i)
            pattern->col(i) =
                (Eigen::Vector3d(-1, 0, 0.3) + 0.3 * noise.normals()).normalized().cast<float>();
    const auto scene = picture::sphereScene({many, few, none}, {"a", "b", "c"});
    const auto coloured = colouredByThird(picture::picture(*scene, picture::sphereView(3)));
    EXPECT_GT(coloured[0], 3 * coloured[1]);
    EXPECT_GT(coloured[1], 100);
    EXPECT_EQ(coloured[2], 0);
}

TEST(FiguresScene, LinesAndTheirPairsAreDrawn) {
    paper::LineCloud lines;
    constexpr Eigen::Index kLines = 200;
    test::Noise noise;
    lines.midpoints.resize(3, kLines);
    lines.directions.resize(3, kLines);
    lines.lengths = Eigen::VectorXf::Constant(kLines, 1);
    for (Eigen::Index i = 0; i < kLines; ++i) {
        lines.midpoints.col(i) = (10 * noise.normals()).cast<float>();
        lines.directions.col(i) = noise.direction().cast<float>();
    }
    for (const auto& scene : {picture::lineScene(lines),
                              picture::matchScene(lines, lines, Eigen::Vector3d(0.5, 0, 0))}) {
        const auto coloured = colouredByThird(picture::picture(*scene, picture::topView()));
        EXPECT_GT(coloured[0] + coloured[1] + coloured[2], 1000);
    }
    // Without lines there is nothing to see, and nothing breaks.
    EXPECT_NO_THROW(picture::lineScene({Eigen::Matrix3Xf(3, 0), Eigen::Matrix3Xf(3, 0), {}, 0}));
}
}  // namespace
