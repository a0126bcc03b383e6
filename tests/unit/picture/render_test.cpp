#include "delio/picture/render.h"

#include <gtest/gtest.h>
#include <mrpt/opengl/CPointCloud.h>
#include <mrpt/opengl/stock_objects.h>
#include <mrpt/system/CTicTac.h>

#include <cmath>
#include <filesystem>
#include <iostream>
#include <set>

#include "delio/core/error.h"
#include "delio/picture/scene.h"
#include "picture_support.h"
#include "test_data.h"

namespace {
using namespace delio;
using mrpt::img::CImage;
using mrpt::img::TColor;
using picture::SnapshotOptions;
using test::bytesOf;
using test::onePointScene;
using test::pixel;
using test::Rgb;
using test::someMap;
using test::someWay;

/** Middle of the pixels that are red. */
std::pair<double, double> placeOfRed(const CImage& image) {
    double u = 0, v = 0, count = 0;
    for (int row = 0; row < static_cast<int>(image.getHeight()); ++row)
        for (int column = 0; column < static_cast<int>(image.getWidth()); ++column)
            if (const auto p = pixel(image, column, row); p[0] > 100 && p[2] < 50) {
                u += column + 0.5;
                v += row + 0.5;
                ++count;
            }
    return count ? std::make_pair(u / count, v / count) : std::make_pair(-1.0, -1.0);
}

TEST(Snapshot, PointsAppearWhereTheyAre) {
    SnapshotOptions options = picture::topView();
    options.zoom_m = 120;
    options.azimuth_deg = -90;  // +x to the right, +y up
    // Widths that are no multiple of four, where rows are padded, and pictures higher than wide.
    for (const auto& [width, height] :
         {std::pair{400U, 300U}, {401U, 303U}, {399U, 200U}, {202U, 405U}})
        for (const auto& [x, y] : {std::pair{0.0, 0.0}, {40.0, 10.0}, {-30.0, -20.0}}) {
            options.width_px = width;
            options.height_px = height;
            const auto scene = onePointScene(x, y);
            const auto image = picture::picture(*scene, options);
            ASSERT_EQ(image.getWidth(), width);
            ASSERT_EQ(image.getHeight(), height);
            const double perMetre = width / 120.0;
            const auto [u, v] = placeOfRed(image);
            EXPECT_NEAR(u, width / 2.0 + x * perMetre, 1.5) << width << " " << x;
            EXPECT_NEAR(v, height / 2.0 - y * perMetre, 1.5) << height << " " << y;
        }
    // From behind: +x up, +y to the left.
    options.azimuth_deg = 180;
    options.width_px = options.height_px = 400;
    const auto [u, v] = placeOfRed(picture::picture(*onePointScene(30, 15), options));
    EXPECT_NEAR(u, 200 - 15 / 0.3, 1.5);
    EXPECT_NEAR(v, 200 - 30 / 0.3, 1.5);
}

TEST(Snapshot, PerspectiveShowsTheMiddleAtTheAskedScale) {
    SnapshotOptions options;
    options.elevation_deg = 90;
    options.azimuth_deg = -90;
    options.zoom_m = 100;
    options.width_px = 500;
    options.height_px = 400;
    const auto [u, v] = placeOfRed(picture::picture(*onePointScene(20, 10), options));
    EXPECT_NEAR(u, 250 + 20 * 5, 2);
    EXPECT_NEAR(v, 200 - 10 * 5, 2);
}

TEST(Snapshot, EverythingFillsThePictureByDefault) {
    const auto points = someMap();
    auto cloud = mrpt::opengl::CPointCloud::Create();
    cloud->loadFromPointsMap(&points);
    cloud->setColor_u8(TColor(0, 255, 0));
    cloud->insertPoint(1e5F, 1e5F, 1e4F);  // a stray that must not count
    auto scene = mrpt::opengl::COpenGLScene::Create();
    scene->insert(cloud);
    for (const bool ortho : {false, true})
        for (const double elevation : {0.0, 30.0, 55.0, 90.0, -20.0})
            for (const double azimuth : {0.0, 77.0, 180.0}) {
                SnapshotOptions options;
                options.width_px = 320;
                options.height_px = 240;
                options.ortho = ortho;
                options.elevation_deg = elevation;
                options.azimuth_deg = azimuth;
                options.background = TColor(255, 0, 255);
                const auto image = picture::picture(*scene, options);
                int left = 320, right = -1, top = 240, bottom = -1;
                for (int row = 0; row < 240; ++row)
                    for (int column = 0; column < 320; ++column)
                        if (pixel(image, column, row)[1] > 100) {
                            left = std::min(left, column);
                            right = std::max(right, column);
                            top = std::min(top, row);
                            bottom = std::max(bottom, row);
                        }
                const std::string which = (ortho ? "ortho " : "perspective ") +
                                          std::to_string(elevation) + " " + std::to_string(azimuth);
                EXPECT_TRUE(right - left > 0.8 * 320 || bottom - top > 0.8 * 240) << which;
                EXPECT_NEAR(left, 319 - right, 20) << which;
                EXPECT_NEAR(top, 239 - bottom, 30) << which;
            }
}

TEST(Snapshot, AMapHasTheColoursOfItsHeights) {
    const auto image = picture::picture(*picture::mapScene(someMap(), {someWay(), {}, {}, {}}), {});
    std::set<Rgb> colours;
    std::size_t covered = 0;
    for (int row = 0; row < static_cast<int>(image.getHeight()); ++row)
        for (int column = 0; column < static_cast<int>(image.getWidth()); ++column) {
            const auto p = pixel(image, column, row);
            colours.insert(p);
            covered += std::max({p[0], p[1], p[2]}) > 60;
        }
    EXPECT_GT(colours.size(), 100U);
    EXPECT_GT(covered, 20000U);
}

TEST(Snapshot, RepeatsAndLeavesTheSceneAsItWas) {
    auto scene = picture::mapScene(someMap(), {someWay(), {}, {}, {}});
    SnapshotOptions options;
    options.width_px = 200;
    options.height_px = 150;
    const auto first = bytesOf(picture::picture(*scene, options));
    SnapshotOptions other = options;
    other.pointSize_px = 9;
    other.background = TColor(255, 255, 255);
    EXPECT_NE(bytesOf(picture::picture(*scene, other)), first);
    EXPECT_EQ(bytesOf(picture::picture(*scene, options)), first);
}

TEST(Snapshot, OrbitGoesAroundTheContentAtOneDistance) {
    // Corners at 50 and 25 m, and one red point on the side of +x.
    auto scene = onePointScene(40, 0);
    SnapshotOptions options;
    options.width_px = options.height_px = 400;
    options.elevation_deg = 20;
    options.azimuth_deg = -90;
    options.ortho = true;
    std::vector<std::pair<double, double>> places;
    picture::orbit(*scene, options, 4, [&](unsigned i, const CImage& image) {
        EXPECT_EQ(i, places.size());
        places.push_back(placeOfRed(image));
    });
    ASSERT_EQ(places.size(), 4U);
    // Seen from -y it is to the right; from +x in front, that is below the middle; and so on.
    const double away = places[0].first - 200;
    EXPECT_GT(away, 100);
    EXPECT_NEAR(places[2].first, 200 - away, 2) << "one distance";
    EXPECT_NEAR(places[1].first, 200, 2);
    EXPECT_GT(places[1].second, 210);
    EXPECT_NEAR(places[3].first, 200, 2);
    EXPECT_LT(places[3].second, 190);
}

TEST(Snapshot, TheScaleBarIsTrue) {
    auto scene = onePointScene(0, 0);
    SnapshotOptions options = picture::topView();
    options.azimuth_deg = -90;
    options.zoom_m = 130;
    options.width_px = 650;
    options.height_px = 400;
    const auto image = picture::picture(*scene, options);
    // 650 px for 130 m: a bar of 20 m has 100 px.
    int longest = 0;
    for (int row = 0; row < 400; ++row) {
        int run = 0;
        for (int column = 0; column < 650; ++column) {
            run = pixel(image, column, row) == Rgb{255, 255, 255} ? run + 1 : 0;
            longest = std::max(longest, run);
        }
    }
    EXPECT_NEAR(longest, 100, 2);
    options.scaleBar = false;
    EXPECT_NE(bytesOf(picture::picture(*scene, options)), bytesOf(image));
}

/** Middle of the pixels that the second picture has and the first has not. */
Eigen::Vector2d placeOfChange(const CImage& a, const CImage& b) {
    Eigen::Vector2d sum(0, 0);
    int count = 0;
    for (int row = 0; row < static_cast<int>(a.getHeight()); ++row)
        for (int column = 0; column < static_cast<int>(a.getWidth()); ++column)
            if (pixel(a, column, row) != pixel(b, column, row)) {
                sum += Eigen::Vector2d(column, row);
                ++count;
            }
    EXPECT_GT(count, 50);
    return sum / std::max(count, 1);
}

TEST(Snapshot, TheArrowPointsNorth) {
    picture::MapWays ways;
    ways.trajectory = someWay();
    SnapshotOptions options = picture::topView();
    options.width_px = 640;
    options.height_px = 400;
    options.azimuth_deg = -90;  // +x to the right
    options.zoom_m = 1000;      // the corner is empty
    const auto drawn = [&](const std::optional<Eigen::Vector3d>& north) {
        ways.north = north;
        const auto scene = picture::mapScene(someMap(), ways);
        options.northArrow = false;
        const auto without = picture::picture(*scene, options);
        options.northArrow = true;
        return placeOfChange(without, picture::picture(*scene, options));
    };
    const Eigen::Vector2d up = drawn(Eigen::Vector3d::UnitY()),
                          down = drawn(-Eigen::Vector3d::UnitY());
    const Eigen::Vector2d right = drawn(Eigen::Vector3d::UnitX());
    // The letter is beyond the tip: what is drawn lies off the middle towards north.
    EXPECT_LT(up.y(), down.y() - 2);
    EXPECT_NEAR(up.x(), down.x(), 1.5);
    EXPECT_GT(right.x(), up.x() + 1);
    EXPECT_LT((drawn({}) - up).norm(), 2) << "y, where north is not known";
    EXPECT_GT(up.x(), 0.85 * 640);
}

TEST(Snapshot, TheArrowIsTheSameInALoadedScene) {
    const test::TemporaryFolder folder;
    picture::MapWays ways;
    ways.north = Eigen::Vector3d(0.6, -0.8, 0);
    const auto scene = picture::mapScene(someMap(), ways);
    picture::saveScene(*scene, folder / "map.3Dscene");
    SnapshotOptions options;
    options.width_px = 640;
    options.height_px = 400;
    options.northArrow = options.scaleBar = true;
    const auto bytes = bytesOf(picture::picture(*scene, options));
    EXPECT_EQ(bytesOf(picture::picture(*picture::loadScene(folder / "map.3Dscene"), options)),
              bytes);
    options.scaleBar = false;
    EXPECT_NE(bytesOf(picture::picture(*scene, options)), bytes) << "a bar in perspective";
}

// Takes a while: run with --gtest_also_run_disabled_tests.
TEST(Snapshot, DISABLED_FiveMillionPointsTakeLessThanFifteenSeconds) {
    mrpt::maps::CSimplePointsMap points;
    constexpr std::int64_t kPoints = 5000000;
    points.reserve(static_cast<std::size_t>(kPoints));
    for (std::int64_t i = 0; i < kPoints; ++i) {
        const double along = 2e-4 * static_cast<double>(i);
        const double across = 0.01 * static_cast<double>(i * 7919 % 3000);
        const double height = i % 5 == 0 ? 0.01 * static_cast<double>(i * 31 % 800) : 0;
        points.insertPointFast(static_cast<float>(along),
                               static_cast<float>(across + 50 * std::sin(along / 80)),
                               static_cast<float>(height));
    }
    const test::TemporaryFolder folder;
    for (const auto& [width, height] : {std::pair{1920U, 1080U}, {3840U, 2160U}}) {
        SnapshotOptions options;
        options.width_px = width;
        options.height_px = height;
        mrpt::system::CTicTac clock;
        picture::savePicture(*picture::mapScene(points, {}), options, folder / "five.png");
        const double time_s = clock.Tac();
        std::cout << width << "x" << height << ": " << time_s << " s\n";
        EXPECT_LT(time_s, 15);
    }
}

TEST(Snapshot, BadRequestsAreErrorsAndLeaveNothing) {
    const test::TemporaryFolder folder;
    auto empty = mrpt::opengl::COpenGLScene::Create();
    EXPECT_THROW(picture::picture(*empty, {}), Error);
    EXPECT_THROW(picture::mapScene(mrpt::maps::CSimplePointsMap(), {}), Error);
    EXPECT_THROW(picture::trajectoryScene({}), Error);
    auto scene = onePointScene(0, 0);
    // MRPT throws in the middle of rendering this one; the message has to be MRPT's own line.
    auto unrenderable = mrpt::opengl::COpenGLScene::Create();
    unrenderable->insert(mrpt::opengl::stock_objects::CornerXYZ(5));
    try {
        picture::picture(*unrenderable, {});
        ADD_FAILURE();
    } catch (const Error& e) {
        EXPECT_EQ(std::string(e.what()).find("cannot render the scene: "), 0U);
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        EXPECT_EQ(std::string(e.what()).find("===="), std::string::npos) << e.what();
    }
    SnapshotOptions options;
    options.width_px = 0;
    EXPECT_THROW(picture::picture(*scene, options), Error);
    options.width_px = picture::kMaxPictureSize_px + 1;
    EXPECT_THROW(picture::picture(*scene, options), Error);
    options.width_px = 64;
    EXPECT_THROW(picture::savePicture(*scene, options, folder / "a.xyz"), Error);
    EXPECT_THROW(picture::savePicture(*scene, options, folder / "no/folder.png"), Error);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Png, GivesTheSamePixelsBack) {
    const test::TemporaryFolder folder;
    // Rows of no whole number of four bytes.
    mrpt::img::CImage image(7, 5, mrpt::img::CH_RGB);
    for (int row = 0; row < 5; ++row)
        for (int column = 0; column < 7; ++column)
            image.setPixel(column, row,
                           mrpt::img::TColor(static_cast<std::uint8_t>(40 * row),
                                             static_cast<std::uint8_t>(30 * column), 200));
    picture::savePng(image, folder / "a.png");
    mrpt::img::CImage read;
    ASSERT_TRUE(read.loadFromFile(folder / "a.png"));
    ASSERT_EQ(read.getWidth(), 7U);
    ASSERT_EQ(read.getHeight(), 5U);
    EXPECT_EQ(test::bytesOf(read), test::bytesOf(image));
}

TEST(Png, OtherNamesAndPlacesAreErrorsAndLeaveNothing) {
    const test::TemporaryFolder folder;
    const mrpt::img::CImage image(4, 4, mrpt::img::CH_RGB);
    EXPECT_NO_THROW(picture::checkPngName(folder / "a.png"));
    EXPECT_THROW(picture::checkPngName(folder / "a.xyz"), Error);
    EXPECT_THROW(picture::savePng(image, folder / "a.xyz"), Error);
    EXPECT_THROW(picture::savePng(image, folder / "no/folder.png"), Error);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}
}  // namespace
