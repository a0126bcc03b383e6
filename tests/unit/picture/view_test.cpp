#include "picture/view.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "delio/core/error.h"

namespace {
using namespace delio;
using Eigen::Vector3d;
using picture::Content;
using picture::SnapshotOptions;
using picture::View;

constexpr double kMargin = 1.05;
constexpr double kDeg = M_PI / 180;

/** Corners of a box about `middle`, of `half` its size. */
Content box(const Vector3d& middle, const Vector3d& half) {
    Content content;
    for (const double x : {-1, 1})
        for (const double y : {-1, 1})
            for (const double z : {-1, 1})
                content.lines.push_back(middle + half.cwiseProduct(Vector3d(x, y, z)));
    return content;
}

SnapshotOptions square(bool ortho, double azimuth_deg, double elevation_deg) {
    SnapshotOptions options;
    options.width_px = options.height_px = 100;
    options.ortho = ortho;
    options.azimuth_deg = azimuth_deg;
    options.elevation_deg = elevation_deg;
    return options;
}

View viewOf(const Content& content, const SnapshotOptions& options) {
    return picture::viewsOf(content, options, 1).at(0);
}

void expectNear(const Vector3d& a, const Vector3d& b) { EXPECT_LT((a - b).norm(), 1e-9) << a; }

TEST(Framing, AzimuthAndElevationSayWhereTheCameraStands) {
    const Content content = box({0, 0, 0}, {1, 1, 1});
    const View side = viewOf(content, square(true, -90, 0));
    expectNear(side.back, {0, -1, 0});
    expectNear(side.right, {1, 0, 0});
    expectNear(side.up, {0, 0, 1});
    const View above = viewOf(content, square(true, 0, 90));
    expectNear(above.back, {0, 0, 1});
    expectNear(above.up, {-1, 0, 0});
    const View between = viewOf(content, square(false, 30, 40));
    expectNear(between.back, {std::cos(30 * kDeg) * std::cos(40 * kDeg),
                              std::sin(30 * kDeg) * std::cos(40 * kDeg), std::sin(40 * kDeg)});
    EXPECT_NEAR(between.right.cross(between.up).dot(between.back), 1, 1e-12);
}

TEST(Framing, WhatIsFartherApartThanFloatsReachIsRefused) {
    for (const bool ortho : {false, true}) {
        Content content = box({0, 0, 0}, {3e38, 3e38, 2});
        EXPECT_THROW(viewOf(content, square(ortho, 0, 40)), Error);
        content = box({0, 0, 0}, {1, 1, 1});
        content.grids = box({0, 0, 0}, {1e30, 1e30, 0}).lines;
        EXPECT_THROW(viewOf(content, square(ortho, 0, 40)), Error);
        EXPECT_NO_THROW(viewOf(box({5e6, 5e5, 0}, {3e4, 3e4, 100}), square(ortho, 0, 40)));
    }
}

TEST(Framing, ABoxFillsAParallelProjection) {
    const Vector3d middle(100, -50, 7);
    const Content content = box(middle, {20, 5, 3});
    // From -y: 40 m across, 6 m up.
    SnapshotOptions options = square(true, -90, 0);
    const View wide = viewOf(content, options);
    expectNear(wide.middle, middle);
    EXPECT_NEAR(wide.metresAcross, 40 * kMargin, 1e-9);
    // A picture eight times as wide as high: now the height decides.
    options.width_px = 800;
    EXPECT_NEAR(viewOf(content, options).metresAcross, 6 * 8 * kMargin, 1e-9);
}

TEST(Framing, ABoxFillsThePerspective) {
    const Vector3d middle(3, 4, 5);
    const View view = viewOf(box(middle, {20, 5, 3}), square(false, -90, 0));
    // The near face, 5 m before the middle, is what has to fit into 30 deg.
    const double tangent = std::tan(15 * kDeg);
    EXPECT_NEAR(view.distance, (5 + 20 / tangent) * kMargin, 1e-9);
    EXPECT_NEAR(view.metresAcross, 2 * tangent * view.distance, 1e-9);
    expectNear(view.middle, middle);
    EXPECT_LT(view.nearest, view.distance - 5);
    EXPECT_GT(view.farthest, view.distance + 5);
}

TEST(Framing, ZoomAsksForMetresAcross) {
    const Content content = box({0, 0, 0}, {20, 5, 3});
    for (const bool ortho : {false, true}) {
        SnapshotOptions options = square(ortho, -90, 0);
        const double whole = viewOf(content, options).metresAcross;
        options.zoom_m = 10;
        const View view = viewOf(content, options);
        EXPECT_EQ(view.metresAcross, 10);
        EXPECT_NEAR(view.magnification, whole / 10, 1e-9);
        if (!ortho) {
            EXPECT_NEAR(view.distance, 5 / std::tan(15 * kDeg), 1e-9);
        }
    }
}

TEST(Framing, TheLongerSideLiesAcross) {
    SnapshotOptions options = square(true, 0, 55);
    options.azimuth_deg.reset();
    // A street at 30 deg: seen from -60 deg, square to it, +x to the right.
    Content street;
    for (int i = -100; i <= 100; ++i)
        street.lines.emplace_back(i * std::cos(30 * kDeg), i * std::sin(30 * kDeg), 0);
    expectNear(viewOf(street, options).right, {std::cos(30 * kDeg), std::sin(30 * kDeg), 0});
    // Straight from above, by right angles only.
    options.elevation_deg = 90;
    expectNear(viewOf(street, options).right, {1, 0, 0});
    expectNear(viewOf(box({0, 0, 0}, {1, 2, 1}), options).right, {0, -1, 0});
}

TEST(Framing, StrayPointsDoNotCountAndLinesDo) {
    Content content;
    for (int i = 0; i <= 1000; ++i) content.points.emplace_back(0.1 * i, 0, 0);
    content.points.emplace_back(1e5, 1e5, 1e4);
    const SnapshotOptions options = square(true, -90, 0);
    // All but a thousandth on either side.
    EXPECT_NEAR(viewOf(content, options).metresAcross, 99.9 * kMargin, 0.02);
    content.lines.emplace_back(200, 0, 0);
    EXPECT_NEAR(viewOf(content, options).metresAcross, 199.9 * kMargin, 0.02);
}

TEST(Framing, AnOrbitIsAboutOneMiddleAndOfOneSize) {
    const Vector3d middle(10, 20, 30);
    const Content content = box(middle, {20, 5, 3});
    for (const bool ortho : {false, true}) {
        const auto views = picture::viewsOf(content, square(ortho, -90, 0), 4);
        ASSERT_EQ(views.size(), 4U);
        for (const auto& view : views) {
            expectNear(view.middle, middle);
            EXPECT_EQ(view.metresAcross, views[0].metresAcross);
        }
        expectNear(views[1].back, {1, 0, 0});
        if (ortho) {
            EXPECT_NEAR(views[0].metresAcross, 40 * kMargin, 1e-9);
        }
    }
}
}  // namespace
