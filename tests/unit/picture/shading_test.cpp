#include "picture/shading.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>

#include "delio/core/error.h"
#include "delio/picture/render.h"
#include "delio/picture/scene.h"
#include "picture/view.h"
#include "picture_support.h"

namespace {
using namespace delio;
using mrpt::img::CImage;
using mrpt::math::CMatrixFloat;
using picture::EyeDome;
using test::bytesOf;
using test::pixel;
using test::Rgb;

constexpr int kWidth = 40, kHeight = 30;
constexpr float kNothing = std::numeric_limits<float>::infinity();

CImage evenImage() {
    CImage image(kWidth, kHeight, mrpt::img::CH_RGB);
    image.filledRectangle(0, 0, kWidth - 1, kHeight - 1, {200, 100, 50});
    return image;
}

template <typename DepthAt>
CMatrixFloat logDepthOf(const DepthAt& depthAt) {
    CMatrixFloat depth(kHeight, kWidth);
    for (int row = 0; row < kHeight; ++row)
        for (int column = 0; column < kWidth; ++column)
            depth(row, column) = static_cast<float>(depthAt(column, row));
    return depth;
}

EyeDome someShading() {
    EyeDome shading;
    shading.radius_px = 2;
    return shading;
}

/** 10 m away on the left, 12 m on the right, from column 20 on. */
CMatrixFloat step() {
    return logDepthOf([](int column, int) { return std::log2(column < 20 ? 10.0 : 12.0); });
}

TEST(EyeDome, WhatLiesBehindAnEdgeIsDark) {
    auto image = evenImage();
    picture::shadeEyeDome(image, step(), someShading());
    const Rgb even = {200, 100, 50};
    for (int row = 0; row < kHeight; ++row) {
        for (int column = 0; column < 20; ++column) EXPECT_EQ(pixel(image, column, row), even);
        EXPECT_LT(pixel(image, 20, row)[0], 50) << "behind the edge";
        EXPECT_LT(pixel(image, 23, row)[0], 200) << "at two radii, too";
        EXPECT_GE(pixel(image, 23, row)[0], pixel(image, 20, row)[0]) << "less than beside it";
        for (int column = 24; column < kWidth; ++column)
            EXPECT_EQ(pixel(image, column, row), even) << column;
    }
}

TEST(EyeDome, EvenSurfacesStayAsTheyAre) {
    const std::string even = bytesOf(evenImage());
    const float steep = 1.F / 1024;
    for (const float slope : {0.F, steep}) {  // without rounding
        auto image = evenImage();
        const auto depth = logDepthOf(
            [&](int column, int row) { return 3 + slope * static_cast<float>(column - row); });
        picture::shadeEyeDome(image, depth, someShading());
        EXPECT_EQ(bytesOf(image), even) << slope;
    }
}

TEST(EyeDome, TheBackgroundStaysAsItIsAndShadesNothing) {
    auto image = evenImage();
    const auto depth = logDepthOf([](int column, int) { return column < 20 ? 3.F : kNothing; });
    picture::shadeEyeDome(image, depth, someShading());
    EXPECT_EQ(bytesOf(image), bytesOf(evenImage()));
}

TEST(EyeDome, NoStrengthNoChangeAndMoreIsDarker) {
    auto none = evenImage(), weak = evenImage(), strong = evenImage();
    EyeDome shading = someShading();
    shading.gain = 0;
    picture::shadeEyeDome(none, step(), shading);
    EXPECT_EQ(bytesOf(none), bytesOf(evenImage()));
    shading.gain = 1;
    picture::shadeEyeDome(weak, step(), shading);
    shading.gain = 10;
    picture::shadeEyeDome(strong, step(), shading);
    EXPECT_GT(pixel(weak, 20, 15)[0], pixel(strong, 20, 15)[0]);
    CMatrixFloat small(3, 3);
    EXPECT_THROW(picture::shadeEyeDome(none, small, shading), Error);
}

TEST(EyeDome, HasTheSameBytesForAnyNumberOfThreads) {
    const auto depth = logDepthOf(
        [](int column, int row) { return 3 + 0.01 * std::sin(7.0 * column + 3.0 * row * row); });
    std::string first;
    for (const std::size_t threads : {1, 2, 5}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        auto image = evenImage();
        picture::shadeEyeDome(image, depth, someShading());
        if (first.empty()) first = bytesOf(image);
        EXPECT_EQ(bytesOf(image), first) << threads;
    }
    EXPECT_NE(first, bytesOf(evenImage()));
}

TEST(EyeDome, DepthOfAParallelProjectionIsThatOfPerspective) {
    picture::View view;
    view.metresAcross = 100;
    view.nearest = 10;
    view.farthest = 200;
    picture::SnapshotOptions options;
    CMatrixFloat depth(1, 3);
    const auto convert = [&] {
        picture::toLogDepth(depth, view, options);
        EXPECT_EQ(depth(0, 2), kNothing);
        return depth(0, 1) - depth(0, 0);
    };
    // About the distance from which perspective shows as much, 1 m makes the same difference.
    const double distance = picture::distanceOf(view, options);
    depth(0, 0) = static_cast<float>(distance);
    depth(0, 1) = static_cast<float>(distance + 1);
    depth(0, 2) = 0;
    const float perspective = convert();
    options.ortho = true;
    // MRPT gives n f / (n + f - z) for z.
    for (const int i : {0, 1})
        depth(0, i) = static_cast<float>(10.0 * 200 / (210 - (distance + i)));
    depth(0, 2) = 0;
    EXPECT_NEAR(convert(), perspective, 0.02 * double{perspective});
}

TEST(EyeDome, AMapIsShadedAndNothingElse) {
    picture::SnapshotOptions shaded, plain;
    shaded.width_px = plain.width_px = 640;
    shaded.height_px = plain.height_px = 400;
    plain.shading = 0;
    const auto differs = [&](mrpt::opengl::COpenGLScene& scene) {
        return bytesOf(picture::picture(scene, shaded)) != bytesOf(picture::picture(scene, plain));
    };
    for (const bool ortho : {false, true}) {
        shaded.ortho = plain.ortho = ortho;
        EXPECT_TRUE(differs(*picture::mapScene(test::someMap(), {test::someWay(), {}, {}, {}})));
        EXPECT_FALSE(differs(*picture::trajectoryScene({test::someWay(), {}, {}, {}})));
        EXPECT_FALSE(differs(*test::onePointScene(20, 10)));
    }
}
}  // namespace
