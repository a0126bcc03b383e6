#pragma once
#include <mrpt/img/CImage.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CPointCloud.h>
#include <mrpt/opengl/CPointCloudColoured.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "poses.h"

namespace delio::test {
using Rgb = std::array<int, 3>;

inline Rgb pixel(const mrpt::img::CImage& image, int column, int row) {
    const auto* bgr =
        image.ptr<std::uint8_t>(static_cast<unsigned>(column), static_cast<unsigned>(row));
    return {bgr[2], bgr[1], bgr[0]};
}

inline std::string bytesOf(const mrpt::img::CImage& image) {
    std::string bytes;
    for (int row = 0; row < static_cast<int>(image.getHeight()); ++row)
        for (int column = 0; column < static_cast<int>(image.getWidth()); ++column)
            for (const int v : pixel(image, column, row)) bytes.push_back(static_cast<char>(v));
    return bytes;
}

/** A plane with a block on it. */
inline mrpt::maps::CSimplePointsMap someMap() {
    mrpt::maps::CSimplePointsMap points;
    for (int i = 0; i < 200; ++i)
        for (int j = 0; j < 100; ++j) {
            const auto x = static_cast<float>(i), y = static_cast<float>(j);
            points.insertPoint(x, y, i > 50 && i < 60 && j > 50 ? 5.F : 0.F);
        }
    return points;
}

inline std::vector<Eigen::Isometry3d> someWay() {
    std::vector<Eigen::Isometry3d> poses;
    for (int i = 0; i < 100; ++i)
        poses.push_back(poseAt(2.0 * i, 20 + 10 * std::sin(0.1 * i), 1.7, 0.1));
    return poses;
}

/** Seen from above: a red point at (x, y) between four blue ones at (+-50, +-25), on black. */
inline mrpt::opengl::COpenGLScene::Ptr onePointScene(double x, double y) {
    auto scene = mrpt::opengl::COpenGLScene::Create();
    auto cloud = mrpt::opengl::CPointCloudColoured::Create();
    cloud->insertPoint({static_cast<float>(x), static_cast<float>(y), 0, 255, 0, 0});
    cloud->setPointSize(4);
    auto corners = mrpt::opengl::CPointCloud::Create();
    for (const float u : {-50.F, 50.F})
        for (const float v : {-25.F, 25.F}) corners->insertPoint(u, v, 0);
    corners->setColor_u8(mrpt::img::TColor(0, 0, 255));
    corners->setPointSize(2);
    scene->insert(cloud);
    scene->insert(corners);
    scene->getViewport()->setCustomBackgroundColor({0, 0, 0});
    return scene;
}
}  // namespace delio::test
