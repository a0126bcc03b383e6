#include "delio/picture/scene.h"

#include <gtest/gtest.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/opengl/stock_objects.h>

#include "delio/core/error.h"
#include "delio/picture/render.h"
#include "picture_support.h"
#include "test_data.h"

namespace {
using namespace delio;
using mrpt::img::CImage;
using picture::SnapshotOptions;
using test::bytesOf;
using test::onePointScene;
using test::pixel;
using test::someMap;
using test::someWay;

TEST(Scene, ReloadsWithTheSamePicture) {
    const test::TemporaryFolder folder;
    for (const auto colormap : {map::Colormap::Turbo, map::Colormap::Viridis}) {
        picture::SceneOptions colours;
        colours.colormap = colormap;
        auto scene = picture::mapScene(someMap(), {someWay(), {}, {}, {}}, colours);
        picture::saveScene(*scene, folder / "map.3Dscene");
        auto loaded = picture::loadScene(folder / "map.3Dscene");
        EXPECT_TRUE(loaded->getByName("map"));
        EXPECT_TRUE(loaded->getByName("trajectory"));
        SnapshotOptions options;
        options.width_px = 640;
        options.height_px = 480;  // with a legend
        EXPECT_EQ(bytesOf(picture::picture(*loaded, options)),
                  bytesOf(picture::picture(*scene, options)));
    }
}

std::size_t redPixels(const CImage& image) {
    std::size_t red = 0;
    for (int row = 0; row < static_cast<int>(image.getHeight()); ++row)
        for (int column = 0; column < static_cast<int>(image.getWidth()); ++column) {
            const auto p = pixel(image, column, row);
            red += p[0] > 190 && p[1] < 70 && p[2] < 70;
        }
    return red;
}

TEST(Scene, AMapShowsItsWaysAndALegend) {
    picture::MapWays ways;
    ways.trajectory = someWay();
    SnapshotOptions options;
    options.pointSize_px = 0.1F;
    const auto plain = picture::mapScene(someMap(), ways);
    EXPECT_FALSE(plain->getByName("ground_truth"));
    EXPECT_TRUE(plain->getViewport("colour_bar"));
    ways.groundTruth = someWay();
    for (auto& pose : ways.groundTruth) pose.translation().y() += 20;
    ways.keyframes = {someWay()[0], someWay()[50]};
    const auto scene = picture::mapScene(someMap(), ways);
    EXPECT_TRUE(scene->getByName("keyframes_z"));
    EXPECT_GT(scene->getViewport()->getTextMessages().messages.size(),
              plain->getViewport()->getTextMessages().messages.size());
    EXPECT_GT(redPixels(picture::picture(*scene, options)),
              redPixels(picture::picture(*plain, options)) + 2000);
}

// Where points fill the picture, too: what is beside the words is the background.
TEST(Scene, TheLegendStandsOnAPlate) {
    SnapshotOptions options = picture::topView();
    options.zoom_m = 60;
    options.pointSize_px = 40;
    const auto scene = picture::mapScene(someMap(), {someWay(), {}, {}, {}});
    const auto image = picture::picture(*scene, options);
    const auto background = [&](int left, int top, int right, int bottom) {
        std::size_t found = 0;
        for (int row = top; row < bottom; ++row)
            for (int column = left; column < right; ++column) {
                const auto p = pixel(image, column, row);
                found += p[0] < 40 && p[1] < 40 && p[2] < 45;
            }
        return static_cast<double>(found) / ((right - left) * (bottom - top));
    };
    EXPECT_LT(background(600, 100, 1300, 800), 0.2);       // points and their shades
    EXPECT_GT(background(45, 1080 - 230, 95, 1070), 0.6);  // the numbers beside the bar
    EXPECT_GT(background(1897, 1030, 1901, 1060), 0.9);    // beside the scale bar
}

TEST(Scene, AMapShowsItsLoops) {
    picture::MapWays ways;
    ways.trajectory = someWay();
    EXPECT_FALSE(picture::mapScene(someMap(), ways)->getByName("loops"));
    ways.loops = {{0, 50}};
    EXPECT_TRUE(picture::mapScene(someMap(), ways)->getByName("loops"));
}

TEST(Scene, IntensityColoursAMapThatHasIt) {
    mrpt::maps::CPointsMapXYZI points;
    for (int i = 0; i < 100; ++i)
        for (int j = 0; j < 100; ++j)
            points.insertPointRGB(static_cast<float>(i), static_cast<float>(j), 0,
                                  i < 50 ? 0.1F : 0.9F, 0, 0);
    picture::SceneOptions options;
    options.colourBy = picture::ColourBy::Intensity;
    options.colormap = map::Colormap::Gray;
    const auto scene = picture::mapScene(points, {}, options);
    SnapshotOptions view = picture::topView();
    view.azimuth_deg = -90;
    view.width_px = 300;
    view.height_px = 200;
    view.pointSize_px = 5;
    const auto image = picture::picture(*scene, view);
    EXPECT_GT(pixel(image, 180, 100)[0], pixel(image, 120, 100)[0] + 100);
    EXPECT_THROW(picture::mapScene(someMap(), {}, options), Error);
}

TEST(Scene, TakesTheColoursOfAnotherMap) {
    picture::SceneOptions gray;
    gray.colormap = map::Colormap::Gray;
    auto scene = picture::mapScene(someMap(), {someWay(), {}, {}, {}});
    const auto before = bytesOf(picture::picture(*scene, {}));
    picture::recolour(*scene, map::Colormap::Gray);
    EXPECT_NE(bytesOf(picture::picture(*scene, {})), before);
    // The same as if the map had been drawn so, legend and all.
    EXPECT_EQ(bytesOf(picture::picture(*scene, {})),
              bytesOf(picture::picture(*picture::mapScene(someMap(), {someWay(), {}, {}, {}}, gray),
                                       {})));
    auto without = mrpt::opengl::COpenGLScene::Create();
    without->insert(mrpt::opengl::stock_objects::CornerXYZSimple(1));
    EXPECT_THROW(picture::recolour(*without, map::Colormap::Gray), Error);
}

TEST(Scene, CutOffIsAnError) {
    const test::TemporaryFolder folder;
    picture::saveScene(*onePointScene(1, 2), folder / "whole.3Dscene");
    const std::string whole = test::readText(folder / "whole.3Dscene");
    for (std::size_t length = 0;
         length<whole.size(); length += length + 40> whole.size() ? 1 : 17) {
        test::writeText(folder / "cut.3Dscene", whole.substr(0, length));
        EXPECT_THROW(picture::loadScene(folder / "cut.3Dscene"), Error) << length;
    }
    test::writeText(folder / "text.3Dscene", "no scene at all");
    EXPECT_THROW(picture::loadScene(folder / "text.3Dscene"), Error);
}

TEST(Scene, LoopsAreSeenFromAbove) {
    const auto orange = [](const std::vector<std::pair<std::size_t, std::size_t>>& loops) {
        const auto image = picture::picture(*picture::trajectoryScene({someWay(), {}, {}, loops}),
                                            picture::topView());
        std::size_t count = 0;
        for (int row = 0; row < static_cast<int>(image.getHeight()); ++row)
            for (int column = 0; column < static_cast<int>(image.getWidth()); ++column) {
                const auto p = pixel(image, column, row);
                count += p[0] > 200 && p[1] > 90 && p[1] < 170 && p[2] < 90;
            }
        return count;
    };
    EXPECT_GT(orange({{0, 50}}), orange({}) + 1000);
}

TEST(Scene, BothTrajectoriesAreSeen) {
    auto truth = someWay();
    for (auto& pose : truth) pose.translation().z() += 30;  // would hide the estimate from above
    auto scene = picture::trajectoryScene({someWay(), truth, {}, {}});
    const auto image = picture::picture(*scene, picture::topView());
    std::size_t red = 0, blue = 0;
    for (int row = 0; row < static_cast<int>(image.getHeight()); ++row)
        for (int column = 0; column < static_cast<int>(image.getWidth()); ++column) {
            const auto p = pixel(image, column, row);
            red += p[0] > 180 && p[1] < 90 && p[2] < 90;
            blue += p[2] > 140 && p[0] < 90;
        }
    EXPECT_GT(red, 2000U);
    EXPECT_GT(blue, 2000U);
}
}  // namespace
