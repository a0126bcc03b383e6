#include "picture/bands.h"

#include <gtest/gtest.h>
#include <mrpt/opengl/CCamera.h>
#include <mrpt/opengl/CFBORender.h>

#include <array>

#include "delio/picture/scene.h"
#include "picture_support.h"

namespace {
using delio::picture::Bands;
using namespace delio;
using mrpt::img::CImage;
using mrpt::opengl::CFBORender;
using mrpt::opengl::COpenGLScene;
using Position = std::array<double, 4>;

TEST(Bands, EachRowIsInOneAndHasItsMarginsUnlessThePictureEnds) {
    for (const unsigned width : {4U, 1920U, 3840U, 16384U})
        for (const unsigned height : {1U, 2U, 270U, 2160U, 16383U, 16384U})
            for (const unsigned margin : {0U, 4U, 16U}) {
                const std::size_t points = std::size_t{margin} * 100000;
                const Bands bands(width, height, margin, points);
                unsigned next = 0;
                for (const auto& band : bands.all) {
                    EXPECT_EQ(band.begin, next);
                    EXPECT_LT(band.begin, band.end);
                    EXPECT_LE(band.first + bands.rows, height);
                    EXPECT_TRUE(band.first == 0 || band.first + margin <= band.begin);
                    EXPECT_TRUE(band.end == height || band.end + margin <= band.first + bands.rows);
                    EXPECT_TRUE(band.end == height || (band.begin % 2 == 0 && band.end % 2 == 0));
                    next = band.end;
                }
                EXPECT_EQ(next, height);
                EXPECT_LE(bands.all.size(), 32U);
            }
}

TEST(Bands, ALargePictureIsInSeveral) {
    EXPECT_EQ(Bands(500, 500, 4, 0).all.size(), 1U);
    const Bands bands(3840, 2160, 4, 0);
    EXPECT_GT(bands.all.size(), 20U);
    EXPECT_LT(bands.rows, 100U);
}

TEST(Bands, ASceneOfManyPointsIsDrawnInFewer) {
    EXPECT_EQ(Bands(3840, 2160, 4, 1000000).all.size(), 17U);
    EXPECT_EQ(Bands(3840, 2160, 4, 5000000).all.size(), 4U);
    EXPECT_EQ(Bands(3840, 2160, 4, std::size_t{1} << 40).all.size(), 1U);
}

constexpr unsigned kWidth = 320, kHeight = 240;

/** In every way that MRPT takes: pixels, shares, and from the other end. */
const Position kPositions[] = {{0, 0, 1, 1},       {15, 30, 16, 120},       {0.25, 0.5, 0.5, 0.25},
                               {-60, -50, 40, 30}, {-0.25, -0.5, 0.1, 0.1}, {1, 1, 5, 1}};

COpenGLScene::Ptr sceneWith(const Position& position) {
    auto scene = picture::mapScene(test::someMap(), {test::someWay(), {}, {}, {}});
    const auto other = scene->createViewport("other");
    const auto& [x, y, width, height] = position;
    other->setViewportPosition(x, y, width, height);
    other->setCustomBackgroundColor({1, 0, 0});
    return scene;
}

mrpt::opengl::CCamera camera() {
    mrpt::opengl::CCamera camera;
    camera.setPointingAt(100, 50, 0);
    camera.setZoomDistance(150);
    return camera;
}

std::string drawn(COpenGLScene& scene, unsigned rows) {
    CFBORender renderer(kWidth, rows);
    renderer.setCamera(scene, camera());
    picture::BandViewports viewports(scene, kHeight, rows);
    std::string bytes;
    for (unsigned first = 0; first < kHeight; first += rows) {
        viewports.show(first);
        CImage band;
        renderer.render_RGB(scene, band);
        bytes += test::bytesOf(band);
    }
    scene.unloadShaders();
    scene.freeOpenGLResources();
    return bytes;
}

// Where a point covers a pixel by a hair, the last digit of its place may say otherwise.
TEST(BandViewports, BandsAreThePicture) {
    for (const auto& position : kPositions) {
        const auto whole = drawn(*sceneWith(position), kHeight);
        for (const unsigned rows : {16U, 60U, 120U}) {
            const auto bands = drawn(*sceneWith(position), rows);
            ASSERT_EQ(bands.size(), whole.size());
            std::size_t others = 0;
            for (std::size_t i = 0; i < whole.size(); ++i) others += bands[i] != whole[i];
            EXPECT_LE(others, whole.size() / 1000)
                << position[0] << " " << position[1] << ", rows " << rows;
        }
    }
}

TEST(BandViewports, AWholePictureIsAsMrptDrawsIt) {
    for (const auto& position : kPositions) {
        const auto scene = sceneWith(position);
        CFBORender renderer(kWidth, kHeight);
        renderer.setCamera(*scene, camera());
        CImage whole;
        renderer.render_RGB(*scene, whole);
        scene->unloadShaders();
        scene->freeOpenGLResources();
        EXPECT_TRUE(drawn(*sceneWith(position), kHeight) == test::bytesOf(whole))
            << position[0] << " " << position[1];
    }
}
}  // namespace
