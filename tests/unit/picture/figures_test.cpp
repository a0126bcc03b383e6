#include "delio/picture/figures.h"
#include "picture/line_scenes.h"

#include <gtest/gtest.h>
#include <mrpt/img/CImage.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "delio/picture/render.h"
#include "delio/picture/scene.h"
#include "picture/view.h"
#include "picture_support.h"
#include "poses.h"
#include "ring_scan.h"
#include "test_data.h"

namespace {
using namespace delio;
using mrpt::img::CImage;
using run::RunFolder;
using test::pixel;

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

TEST(FiguresScene, NormalsOnTheFarSideOfTheSphereArePaler) {
    const auto darkest = [](const Eigen::Vector3f& normal) {
        const Eigen::Matrix3Xf pattern = normal.normalized().replicate(1, 5);
        const auto view = picture::sphereView(1);
        const auto picture = picture::picture(*picture::sphereScene({pattern}, {}), view);
        int least = 255;
        for (unsigned y = 0; y < picture.getHeight(); ++y)
            for (unsigned x = 0; x < picture.getWidth(); ++x)
                least = std::min<int>(least, picture.at<uint8_t>(x, y, 2));
        return least;
    };
    EXPECT_LT(darkest({-1, 0.2F, 0.1F}) + 40, darkest({1, 0.2F, -0.1F}));
}

TEST(FiguresScene, MeanShiftShowsSeedsWindowsAndModes) {
    const Eigen::Matrix3Xf none(3, 0), seeds = Eigen::Vector3f(-1, 0, 0).replicate(1, 3);
    paper::Mode mode;
    mode.direction = Eigen::Vector3d(-1, 0, 0.3).normalized();
    const auto drawn = [&](const std::vector<paper::Mode>& modes) {
        const auto scene = picture::meanShiftScene(none, seeds, modes, 20, none);
        return colouredByThird(picture::picture(*scene, picture::sphereView(3)));
    };
    const auto with = drawn({mode}), without = drawn({});
    EXPECT_EQ(with[0], 0);  // seeds are black
    EXPECT_GT(with[1], 100);
    EXPECT_GT(with[2], 20);
    EXPECT_GT(with[1], with[2]);
    EXPECT_EQ(without[1] + without[2], 0);
}

TEST(FiguresScene, KeptLinesCoverThoseDrawn) {
    paper::LineCloud lines;
    lines.midpoints = Eigen::Vector3f(5, 0, 0);
    lines.directions = Eigen::Vector3f(0, 1, 0);
    lines.lengths = Eigen::VectorXf::Constant(1, 2);
    const Eigen::Matrix3Xf outline =
        (Eigen::Matrix3Xf(3, 4) << 4, 6, 6, 4, -1, -1, 1, 1, 0, 0, 0, 0).finished();
    const auto redAndGreen = [&](const paper::LineCloud& kept) {
        const auto scene = picture::binScene(outline, outline, lines, kept);
        auto view = picture::topView();
        view.width_px = 400;  // no legend, whose letters are coloured too
        view.marks = 6;
        const auto picture = picture::picture(*scene, view);
        std::pair<int, int> count;
        for (unsigned y = 0; y < picture.getHeight(); ++y)
            for (unsigned x = 0; x < picture.getWidth(); ++x) {
                const auto p = pixel(picture, static_cast<int>(x), static_cast<int>(y));
                count.first += p[0] > 150 && p[1] < 100;
                count.second += p[1] > 120 && p[0] < 100 && p[2] < 100;
            }
        return count;
    };
    const auto rejected = redAndGreen({Eigen::Matrix3Xf(3, 0), Eigen::Matrix3Xf(3, 0), {}, 0});
    EXPECT_GT(rejected.first, 50);
    EXPECT_EQ(rejected.second, 0);
    const auto kept = redAndGreen(lines);
    EXPECT_EQ(kept.first, 0);
    EXPECT_GT(kept.second, 50);
}

TEST(FiguresScene, TheScannerHasABeamForEachDirection) {
    const auto coloured = [](const Eigen::Matrix3Xf& beams) {
        const auto by = colouredByThird(picture::picture(*picture::scannerScene(beams), {}));
        return by[0] + by[1] + by[2];
    };
    Eigen::Matrix3Xf beams(3, 2);
    beams << 1, 1, 0, 0, 0, -1;
    EXPECT_EQ(coloured(Eigen::Matrix3Xf(3, 0)), 0);
    const int one = coloured(beams.leftCols(1));
    EXPECT_GT(one, 100);
    EXPECT_GT(coloured(beams), one);
}

TEST(PaperStages, DrawEachScanAndPairItsLinesWithThoseOfTheScanBefore) {
    picture::PaperStages stages{PaperOdometryOptions()};
    test::Noise noise;
    const auto scanAt = [&](const Eigen::Isometry3d& pose) {
        return test::scanOf(
            test::ringScan(test::yard(), pose, {48, 900, -24, 8, 0.01}, noise).points);
    };
    const auto moved = test::poseAt(0.5, 0, 0);
    const auto first = stages.add(scanAt(test::poseAt(0, 0, 0)), test::poseAt(0, 0, 0)),
               second = stages.add(scanAt(moved), moved);
    for (const auto& scenes : {first, second}) {
        const auto view = picture::sphereView(1);
        EXPECT_GT(colouredByThird(picture::picture(*scenes.pattern, view))[1], 100);
    }
    EXPECT_FALSE(first.matches);
    ASSERT_TRUE(second.matches);
    EXPECT_EQ(second.matches->getViewport()->size(), 3U);  // lines of either scan, and the pairs
}

bool isRed(const test::Rgb& p) { return p[0] > 120 && p[1] < p[0] / 3 && p[2] < p[0] / 3; }

map::BuiltMap someBuiltMap() {
    map::BuiltMap map;
    map.points = map::pointsOf(test::someMap());
    for (int i = 0; i < 200; ++i) {
        map::MapPoint point;
        point.position = {100 + 0.2F * static_cast<float>(i % 20), 20,
                          0.2F * static_cast<float>(i / 20)};
        map.dynamic.push_back(point);
    }
    return map;
}

run::RunRecord someRecord() {
    run::RunRecord record;
    record.final.poses = record.odometry.poses = test::someWay();
    return record;
}

TEST(RemovalPicture, ShowsTheSameViewBeforeAndAfter) {
    const test::TemporaryFolder folder;
    const RunFolder results(folder.path().string());
    picture::illustrate(someRecord(), someBuiltMap(), results);
    CImage sheet;
    ASSERT_TRUE(sheet.loadFromFile(results.path(RunFolder::kRemovalPicture)));
    ASSERT_EQ(sheet.getWidth(), 2 * 1920U);
    ASSERT_EQ(sheet.getHeight(), 1080U);
    std::size_t redBefore = 0, redAfter = 0, otherwise = 0;
    for (int row = 0; row < 800; ++row)  // above the legend
        for (int column = 0; column < 1920; ++column) {
            const auto before = pixel(sheet, column, row), after = pixel(sheet, column + 1920, row);
            redBefore += isRed(before);
            redAfter += isRed(after);
            otherwise += before != after;
        }
    EXPECT_GT(redBefore, 100U);
    EXPECT_EQ(redAfter, 0U);
    EXPECT_LT(otherwise, 6 * redBefore)
        << "but for the red points, and around them, it is the same";
    std::size_t captions = 0;
    for (int row = 800; row < 1080; ++row)
        for (int column = 0; column < 480; ++column)
            captions += pixel(sheet, column, row) != pixel(sheet, column + 1920, row);
    EXPECT_GT(captions, 100U) << "each has its own";
}

TEST(RemovalPicture, IsThereOnlyWhereSomethingMoved) {
    const test::TemporaryFolder folder;
    const RunFolder results(folder.path().string());
    auto map = someBuiltMap();
    map.dynamic.clear();
    picture::illustrate(someRecord(), map, results);
    EXPECT_TRUE(results.has(RunFolder::kMapPicture));
    EXPECT_FALSE(results.has(RunFolder::kRemovalPicture));
    map = someBuiltMap();
    map.points.clear();
    picture::illustrate(someRecord(), map, results);
    EXPECT_FALSE(results.has(RunFolder::kRemovalPicture));
}

TEST(PointSpacing, IsThatOfTheSurfaces) {
    for (const float spacing : {0.05F, 0.2F, 3.F}) {
        mrpt::maps::CSimplePointsMap points;
        for (int i = 0; i < 100; ++i)
            for (int j = 0; j < 100; ++j)
                points.insertPoint(spacing * static_cast<float>(i), spacing * static_cast<float>(j),
                                   0.1F);
        EXPECT_NEAR(picture::mapSpacing_m(*picture::mapScene(points, {})), spacing,
                    0.3 * double{spacing});
    }
    EXPECT_EQ(picture::mapSpacing_m(*picture::trajectoryScene({test::someWay(), {}, {}, {}})), 0);
}

TEST(PointSpacing, FromNearPointsGrowUntilSurfacesAreClosed) {
    // A level plane seen from above: whatever is shown of it, no gap is left.
    mrpt::maps::CSimplePointsMap points;
    for (int i = 0; i < 300; ++i)
        for (int j = 0; j < 300; ++j)
            points.insertPoint(0.2F * static_cast<float>(i), 0.2F * static_cast<float>(j),
                               i % 50 == 0 ? 0.05F : 0);
    picture::SnapshotOptions options = picture::topView();
    options.width_px = 800;
    options.height_px = 600;
    options.scaleBar = false;
    options.shading = 0;
    options.background = mrpt::img::TColor(255, 0, 255);
    for (const double zoom : {60.0, 30.0, 20.0}) {
        options.zoom_m = zoom;
        const auto image = picture::picture(*picture::mapScene(points, {}), options);
        std::size_t gaps = 0;
        for (int row = 200; row < 400; ++row)
            for (int column = 300; column < 500; ++column)
                gaps += pixel(image, column, row) == test::Rgb{255, 0, 255};
        EXPECT_LT(gaps, 400U) << zoom;
    }
}
}  // namespace
