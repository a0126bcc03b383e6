#include "delio/map/scene.h"

#include <mrpt/opengl/CGridPlaneXY.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/stock_objects.h>

#include <algorithm>
#include <cmath>

#include "delio/error.h"
#include "delio/io/output_file.h"
#include "ground_height.h"
#include "gz_object.h"

namespace delio::map {
using mrpt::img::TColor;
using mrpt::img::TColorf;
using mrpt::opengl::COpenGLScene;
using mrpt::poses::CPose3D;

namespace {
const TColor kWhite(255, 255, 255), kRed(214, 39, 40), kBlue(31, 119, 180);
const TColor kGreen(60, 200, 80), kGridGray(150, 150, 150);

/** Extent over the ground, and a height for the grid. */
struct Extent {
    double xMin = 0, xMax = 0, yMin = 0, yMax = 0, z = 0;
    double longer() const { return std::max(xMax - xMin, yMax - yMin); }
};

Extent extentOf(const std::vector<CPose3D>& poses) {
    Extent e{poses[0].x(), poses[0].x(), poses[0].y(), poses[0].y(), poses[0].z()};
    for (const auto& pose : poses) {
        e.xMin = std::min(e.xMin, pose.x());
        e.xMax = std::max(e.xMax, pose.x());
        e.yMin = std::min(e.yMin, pose.y());
        e.yMax = std::max(e.yMax, pose.y());
        e.z = std::min(e.z, pose.z());
    }
    return e;
}

Extent extentOf(const mrpt::maps::CPointsMap& points) {
    const auto range = [](const auto& values) {
        return robustRange({values.begin(), values.end()});
    };
    const auto x = range(points.getPointsBufferRef_x());
    const auto y = range(points.getPointsBufferRef_y());
    return {x.low, x.high, y.low, y.high, range(points.getPointsBufferRef_z()).low};
}

/** 1, 2 or 5 times a power of ten, so that six to fifteen steps cover the length. */
double roundStep(double length_m) {
    const double raw = std::max(length_m, 1.0) / 8;
    const double power = std::pow(10, std::floor(std::log10(raw)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (raw <= factor * power * 1.3) return factor * power;
    return 10 * power;
}

void addText(COpenGLScene& scene, unsigned row, const std::string& text, const TColor& colour) {
    mrpt::opengl::TFontParams font;
    font.vfont_name = "sans";
    font.vfont_scale = 14;
    font.color = TColorf(colour);
    // From the lower left corner upwards, in pixels.
    scene.getViewport()->addTextMessage(15, 15 + 24 * row, text, row, font);
}

void addGrid(COpenGLScene& scene, const Extent& extent, double beyond_m, const TColor& textColour) {
    const double step = roundStep(extent.longer());
    const auto down = [&](double v) { return static_cast<float>(std::floor(v / step) * step); };
    const auto up = [&](double v) { return static_cast<float>(std::ceil(v / step) * step); };
    auto grid = mrpt::opengl::CGridPlaneXY::Create(
        down(extent.xMin - beyond_m), up(extent.xMax + beyond_m), down(extent.yMin - beyond_m),
        up(extent.yMax + beyond_m), static_cast<float>(extent.z), static_cast<float>(step));
    grid->setColor_u8(kGridGray);
    grid->setName("grid");
    scene.insert(grid);
    std::string text = std::to_string(step);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    addText(scene, 0, "grid " + text + " m", textColour);
}

/** The way as a line that looks thick: MRPT draws every line one pixel wide, but the ends of its
 *  pieces as dots of any size, so the pieces are made short. */
void addWay(COpenGLScene& scene, const std::vector<CPose3D>& poses, double extent_m,
            const TColor& colour, float width_px, const std::string& name) {
    const double piece_m = std::max(extent_m, 1.0) / 1500;
    auto way = mrpt::opengl::CSetOfLines::Create();
    for (std::size_t i = 1; i < poses.size(); ++i) {
        const auto from = poses[i - 1].translation(), to = poses[i].translation();
        const int pieces = std::clamp(static_cast<int>((to - from).norm() / piece_m), 1, 1000);
        for (int k = 0; k < pieces; ++k)
            way->appendLine(from + (to - from) * (double(k) / pieces),
                            from + (to - from) * (double(k + 1) / pieces));
    }
    way->setColor_u8(colour);
    way->setVerticesPointSize(width_px);
    way->enableVariablePointSize(false);
    way->setName(name);
    if (!way->empty()) scene.insert(way);
}

void addMark(COpenGLScene& scene, const CPose3D& pose, const TColor& colour, double extent_m,
             const std::string& name) {
    auto dot = mrpt::opengl::CPointCloudColoured::Create();
    dot->insertPoint({static_cast<float>(pose.x()), static_cast<float>(pose.y()),
                      static_cast<float>(pose.z()), colour.R, colour.G, colour.B});
    dot->setPointSize(14);
    dot->enableVariablePointSize(false);
    dot->setName(name);
    scene.insert(dot);
    // Not CornerXYZ, which throws in a render when it is larger than 4 m.
    auto axes = mrpt::opengl::stock_objects::CornerXYZSimple(static_cast<float>(extent_m / 40));
    axes->setPose(pose);
    axes->setName(name + "_axes");
    scene.insert(axes);
}
}  // namespace

COpenGLScene::Ptr mapScene(const mrpt::maps::CPointsMap& points, const std::vector<CPose3D>& poses,
                           const SceneOptions& options) {
    if (points.empty()) throw Error("the map has no points, so there is nothing to show");
    const auto& x = points.getPointsBufferRef_x();
    const auto& y = points.getPointsBufferRef_y();
    const auto& z = points.getPointsBufferRef_z();
    const GroundHeight ground(points);
    std::vector<float> heights(x.size());
    for (std::size_t i = 0; i < x.size(); ++i)
        heights[i] = static_cast<float>(z[i] - ground.at(x[i], y[i]));
    const ValueRange range = robustRange(heights);

    auto cloud = mrpt::opengl::CPointCloudColoured::Create();
    cloud->reserve(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        const TColor c = colourAt(options.colormap, range.fractionAt(heights[i]));
        cloud->insertPoint({x[i], y[i], z[i], c.R, c.G, c.B});
    }
    cloud->setPointSize(options.pointSize_px);
    cloud->enableVariablePointSize(false);
    cloud->setName("map");

    auto scene = COpenGLScene::Create();
    scene->getViewport()->setCustomBackgroundColor(TColorf(options.background));
    const Extent extent = extentOf(points);
    const TColor& b = options.background;
    const TColor ink = b.R + b.G + b.B > 3 * 128 ? TColor(0, 0, 0) : kWhite;
    addGrid(*scene, extent, extent.longer() / 20, ink);
    scene->insert(cloud);
    if (!poses.empty()) {
        addWay(*scene, poses, extent.longer(), ink, 4, "trajectory");
        addMark(*scene, poses.front(), kGreen, extent.longer(), "start");
        addMark(*scene, poses.back(), kRed, extent.longer(), "end");
    }
    return scene;
}

COpenGLScene::Ptr trajectoryScene(const std::vector<CPose3D>& estimate,
                                  const std::vector<CPose3D>& groundTruth,
                                  const std::string& name) {
    if (estimate.empty()) throw Error("the trajectory has no poses, so there is nothing to show");
    auto all = estimate;
    all.insert(all.end(), groundTruth.begin(), groundTruth.end());
    const Extent extent = extentOf(all);
    const double size_m = std::max(extent.longer(), 1.0);

    auto scene = COpenGLScene::Create();
    scene->getViewport()->setCustomBackgroundColor(TColorf(kWhite));
    addGrid(*scene, extent, size_m, TColor(60, 60, 60));
    if (!groundTruth.empty()) {
        const auto byHeight = [](const CPose3D& a, const CPose3D& b) { return a.z() < b.z(); };
        const double top = std::max_element(groundTruth.begin(), groundTruth.end(), byHeight)->z();
        const double bottom = std::min_element(estimate.begin(), estimate.end(), byHeight)->z();
        auto below = groundTruth;
        for (auto& pose : below) pose.z_incr(std::min(0.0, bottom - top - size_m / 100));
        addWay(*scene, below, size_m, kRed, 7, "ground_truth");
        addText(*scene, 2, "ground truth", kRed);
    }
    addWay(*scene, estimate, size_m, kBlue, 3, "trajectory");
    addText(*scene, 1, name, kBlue);
    addMark(*scene, estimate.front(), kGreen, size_m, "start");
    addMark(*scene, estimate.back(), kRed, size_m, "end");
    return scene;
}

void saveScene(const COpenGLScene& scene, const std::string& path) {
    io::replaceFile(path,
                    [&](const std::string& temporary) { return scene.saveToFile(temporary); });
}

COpenGLScene::Ptr loadScene(const std::string& path) {
    auto scene = COpenGLScene::Create();
    loadWhole(path, "a .3Dscene", *scene);
    return scene;
}
}  // namespace delio::map
