#include "delio/picture/scene.h"

#include <mrpt/opengl/CArrow.h>
#include <mrpt/opengl/CAxis.h>
#include <mrpt/opengl/CCylinder.h>
#include <mrpt/opengl/CDisk.h>
#include <mrpt/opengl/CEllipsoid2D.h>
#include <mrpt/opengl/CEllipsoid3D.h>
#include <mrpt/opengl/CGridPlaneXY.h>
#include <mrpt/opengl/CGridPlaneXZ.h>
#include <mrpt/opengl/CPointCloud.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/opengl/CSphere.h>
#include <mrpt/opengl/stock_objects.h>

#include <algorithm>
#include <cmath>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "map/ground.h"
#include "mrpt/object_file.h"
#include "picture/legend.h"
#include "picture/view.h"

namespace delio::picture {
using Eigen::Isometry3d;
using map::Colormap;
using map::colourAt;
using map::robustRange;
using map::ValueRange;
using mrpt::img::TColor;
using mrpt::img::TColorf;
using mrpt::opengl::COpenGLScene;

namespace {
using mrpt::opengl::CRenderizable;

/** Lines from `low` to `high`, one every `step`; MRPT adds the step in single precision, which far
 *  from 0 may come to nothing. */
void checkLines(float low, float high, float step, float most) {
    constexpr float kFarthest = 1e6F;  // steps
    const bool ends = step > 0 && std::isfinite(step) && (high - low) / step <= most &&
                      std::abs(low) / step < kFarthest && std::abs(high) / step < kFarthest;
    if (!ends) throw Error("has a grid or axis of more lines than can be drawn");
}

template <typename Grid>
void checkGrid(const Grid& grid) {
    float low1 = 0, high1 = 0, low2 = 0, high2 = 0;
    grid.getPlaneLimits(low1, high1, low2, high2);
    constexpr float kMost = 20'000;
    checkLines(low1, high1, grid.getGridFrequency(), kMost);
    checkLines(low2, high2, grid.getGridFrequency(), kMost);
}

void checkAxis(const mrpt::opengl::CAxis& axis) {
    const auto box = axis.getBoundingBoxLocal();
    constexpr float kMost = 2000;  // each with a text
    for (int k = 0; k < 3; ++k)
        checkLines(static_cast<float>(box.min[k]), static_cast<float>(box.max[k]),
                   axis.getFrequency(), kMost);
}

template <typename Shape>
std::shared_ptr<Shape> as(const CRenderizable::Ptr& object) {
    return std::dynamic_pointer_cast<Shape>(object);
}

void round(const CRenderizable::Ptr& object) {
    constexpr unsigned kUsual = 30, kMost = 1000;
    if (const auto cylinder = as<mrpt::opengl::CCylinder>(object))
        cylinder->setSlicesCount(std::min(cylinder->getSlicesCount(), kMost));
    else if (const auto arrow = as<mrpt::opengl::CArrow>(object))
        arrow->setSlicesCount(std::min(arrow->getSlicesCount(), kMost));
    else if (const auto disk = as<mrpt::opengl::CDisk>(object))
        disk->setSlicesCount(kUsual);
    else if (const auto flat = as<mrpt::opengl::CEllipsoid2D>(object))
        flat->set2DsegmentsCount(kUsual);
    else if (const auto sphere = as<mrpt::opengl::CSphere>(object)) {
        sphere->setNumberDivsLongitude(kUsual);
        sphere->setNumberDivsLatitude(kUsual);
    } else if (const auto ellipsoid = as<mrpt::opengl::CEllipsoid3D>(object))
        ellipsoid->set3DsegmentsCount(kUsual);
}

const TColor kWhite(255, 255, 255), kRed(214, 39, 40), kBlue(31, 119, 180);
const TColor kGreen(60, 200, 80), kYellow(255, 210, 0), kGridGray(150, 150, 150);
const TColor kOrange(255, 127, 14);

/** Sees to it that MRPT can draw a scene that was read from a file: round shapes get as many
 *  corners as they are seen with at most. Throws Error for a scene without a main view, and for
 *  grids and axes whose lines it would draw for ever. */
void makeDrawable(mrpt::opengl::COpenGLScene& scene) {
    if (!scene.getViewport()) throw Error("has no main view");
    scene.visitAllObjects([](const CRenderizable::Ptr& object) {
        if (const auto grid = as<mrpt::opengl::CGridPlaneXY>(object)) checkGrid(*grid);
        if (const auto grid = as<mrpt::opengl::CGridPlaneXZ>(object)) checkGrid(*grid);
        if (const auto axis = as<mrpt::opengl::CAxis>(object)) checkAxis(*axis);
        round(object);
    });
}

/** Extent over the ground, and a height for the grid. */
struct Extent {
    double xMin = 0, xMax = 0, yMin = 0, yMax = 0, z = 0;
    double longer() const { return std::max(xMax - xMin, yMax - yMin); }
};

Extent extentOf(const std::vector<Isometry3d>& poses) {
    Eigen::Vector3d low = poses[0].translation(), high = low;
    for (const auto& pose : poses) {
        low = low.cwiseMin(pose.translation());
        high = high.cwiseMax(pose.translation());
    }
    return {low.x(), high.x(), low.y(), high.y(), low.z()};
}

Extent extentOf(const map::MapPoints& points) {
    const auto range = [&](int axis) {
        std::vector<float> values;
        values.reserve(points.size());
        for (const auto& point : points) values.push_back(point.position[axis]);
        return robustRange(std::move(values));
    };
    const auto x = range(0), y = range(1);
    return {x.low, x.high, y.low, y.high, range(2).low};
}

void addGrid(COpenGLScene& scene, const Extent& extent, double beyond_m, const TColor& textColour) {
    const double step = roundLength(std::max(extent.longer(), 1.0) / 8);
    const auto down = [&](double v) { return static_cast<float>(std::floor(v / step) * step); };
    const auto up = [&](double v) { return static_cast<float>(std::ceil(v / step) * step); };
    auto grid = mrpt::opengl::CGridPlaneXY::Create(
        down(extent.xMin - beyond_m), up(extent.xMax + beyond_m), down(extent.yMin - beyond_m),
        up(extent.yMax + beyond_m), static_cast<float>(extent.z), static_cast<float>(step));
    grid->setColor_u8(kGridGray);
    grid->setName("grid");
    scene.insert(grid);
    addLegendText(scene, 0, "grid " + metresText(step), textColour);
}

mrpt::math::TPoint3D pointOf(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

void addWay(COpenGLScene& scene, const std::vector<Isometry3d>& poses, double extent_m,
            const TColor& colour, float width_px, const std::string& name) {
    const double piece_m = std::max(extent_m, 1.0) / 1500;
    auto way = wideLines(colour, width_px);
    for (std::size_t i = 1; i < poses.size(); ++i)
        appendWide(*way, poses[i - 1].translation(), poses[i].translation(), piece_m);
    way->setName(name);
    if (!way->empty()) scene.insert(way);
}

/** In the legend's row, too. Above the ways, so that it is seen on them from above. */
void addLoops(COpenGLScene& scene, const MapWays& ways, double extent_m, unsigned row) {
    if (ways.loops.empty()) return;
    auto lines = wideLines(kOrange, 5);
    const Eigen::Vector3d above(0, 0, std::clamp(extent_m / 600, 0.2, 1.2));
    for (const auto& [from, to] : ways.loops)
        appendWide(*lines, ways.trajectory.at(from).translation() + above,
                   ways.trajectory.at(to).translation() + above, std::max(extent_m, 1.0) / 1500);
    lines->setName("loops");
    scene.insert(lines);
    addLegendText(scene, row, std::to_string(ways.loops.size()) + " loops closed", kOrange);
}

void addMark(COpenGLScene& scene, const Isometry3d& pose, const TColor& colour, double extent_m,
             const std::string& name) {
    auto dot = mrpt::opengl::CPointCloudColoured::Create();
    const Eigen::Vector3f at = pose.translation().cast<float>();
    dot->insertPoint({at.x(), at.y(), at.z(), colour.R, colour.G, colour.B});
    dot->setPointSize(14);
    dot->enableVariablePointSize(false);
    dot->setName(name);
    scene.insert(dot);
    // Not CornerXYZ, which throws in a render when it is larger than 4 m.
    auto axes = mrpt::opengl::stock_objects::CornerXYZSimple(static_cast<float>(extent_m / 40));
    axes->setPose(toMrpt(pose));
    axes->setName(name + "_axes");
    scene.insert(axes);
}

/** Axes at each keyframe; all x in one object, all y in another, all z in a third. */
void addKeyframes(COpenGLScene& scene, const std::vector<Isometry3d>& poses, double length_m) {
    const TColor colours[] = {TColor(255, 80, 80), TColor(80, 220, 80), TColor(90, 140, 255)};
    for (const int axis : {0, 1, 2}) {
        auto lines = mrpt::opengl::CSetOfLines::Create();
        const Eigen::Vector3d tip = length_m * Eigen::Vector3d::Unit(axis);
        for (const auto& pose : poses)
            lines->appendLine(pointOf(pose.translation()), pointOf(pose * tip));
        lines->setColor_u8(colours[axis]);
        lines->setName(std::string("keyframes_") + "xyz"[axis]);
        scene.insert(lines);
    }
}
/** An object that draws nothing: its x axis points north. */
void addNorth(COpenGLScene& scene, const std::optional<Eigen::Vector3d>& north) {
    if (!north) return;
    const auto mark = mrpt::opengl::CSetOfObjects::Create();
    mark->setName(kNorthName);
    mark->setPose(mrpt::poses::CPose3D(0, 0, 0, std::atan2(north->y(), north->x()), 0, 0));
    scene.insert(mark);
}

using mrpt::opengl::CPointCloudColoured;

/** Those that are more than marks. Throws Error without any. */
std::vector<CPointCloudColoured::Ptr> colouredClouds(COpenGLScene& scene) {
    std::vector<CPointCloudColoured::Ptr> clouds;
    scene.visitAllObjects([&](const CRenderizable::Ptr& object) {
        const auto cloud = as<CPointCloudColoured>(object);
        if (cloud && cloud->size() > 1) clouds.push_back(cloud);
    });
    if (clouds.empty()) throw Error("the scene has no coloured cloud of points");
    return clouds;
}

void copyPoint(CPointCloudColoured& cloud, std::size_t from, std::size_t to) {
    const auto p = cloud.getPoint3Df(from);
    const TColor c = cloud.getPointColor(from);
    cloud.setPoint_fast(to, p.x, p.y, p.z);
    cloud.setPointColor_u8_fast(to, c.R, c.G, c.B, c.A);
}

std::vector<float> heightsOf(const CPointCloudColoured& cloud) {
    return map::heightsAboveGround(cloud.size(), [&](std::size_t i) {
        const auto& p = cloud.getPoint3Df(i);
        return Eigen::Vector3f(p.x, p.y, p.z);
    });
}
}  // namespace

void addRemoved(COpenGLScene& scene, const map::MapPoints& removed) {
    auto cloud = mrpt::opengl::CPointCloud::Create();
    cloud->reserve(removed.size());
    for (const auto& point : removed)
        cloud->insertPoint(point.position.x(), point.position.y(), point.position.z());
    cloud->setColor_u8(TColor(255, 50, 50));
    cloud->setPointSize(SceneOptions().pointSize_px);
    cloud->enableVariablePointSize(false);
    cloud->setName(kRemovedName);
    scene.insert(cloud);
}

COpenGLScene::Ptr mapScene(const mrpt::maps::CPointsMap& points, const MapWays& ways,
                           const SceneOptions& options) {
    return mapScene(map::pointsOf(points), ways, options);
}

COpenGLScene::Ptr mapScene(const map::MapPoints& points, const MapWays& ways,
                           const SceneOptions& options) {
    if (points.empty()) throw Error("the map has no points, so there is nothing to show");
    const auto colours = map::coloursOf(points, {options.colourBy, options.colormap});
    auto cloud = mrpt::opengl::CPointCloudColoured::Create();
    cloud->reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3f& p = points[i].position;
        const TColor& c = colours.ofPoints[i];
        cloud->insertPoint({p.x(), p.y(), p.z(), c.R, c.G, c.B});
    }
    cloud->setPointSize(options.pointSize_px);
    cloud->enableVariablePointSize(false);
    cloud->setName(kMapName);

    auto scene = COpenGLScene::Create();
    scene->getViewport()->setCustomBackgroundColor(TColorf(options.background));
    const Extent extent = extentOf(points);
    const TColor& b = options.background;
    const TColor ink = b.R + b.G + b.B > 3 * 128 ? TColor(0, 0, 0) : kWhite;
    unsigned row = 0;
    addGrid(*scene, extent, extent.longer() / 20, ink);
    if (!options.caption.empty()) addLegendText(*scene, ++row, options.caption, ink);
    scene->insert(cloud);
    addNorth(*scene, ways.north);
    if (!ways.keyframes.empty()) {
        addKeyframes(*scene, ways.keyframes, std::clamp(extent.longer() / 100, 0.5, 3.0));
        addLegendText(*scene, ++row, "axes: keyframes", ink);
    }
    if (!ways.groundTruth.empty()) {
        auto below = ways.groundTruth;
        const double lower_m = std::clamp(extent.longer() / 600, 0.2, 1.2);
        for (auto& pose : below) pose.translation().z() -= lower_m;
        addWay(*scene, below, extent.longer(), kRed, 6, "ground_truth");
        addLegendText(*scene, ++row, "ground truth", TColor(255, 90, 90));
    }
    if (!ways.trajectory.empty()) {
        addWay(*scene, ways.trajectory, extent.longer(), ink, 4, "trajectory");
        addMark(*scene, ways.trajectory.front(), kGreen, extent.longer(), "start");
        addMark(*scene, ways.trajectory.back(), kYellow, extent.longer(), "end");
        for (const auto& way : ways.others)
            addWay(*scene, way, extent.longer(), ink, 4, "trajectory");
        addLegendText(*scene, ++row, "trajectory, from green to yellow", ink);
        if (!ways.loops.empty()) addLoops(*scene, ways, extent.longer(), ++row);
    }
    if (colours.range)
        addColourBar(*scene, row + 1, options.colormap, *colours.range, colours.unit, colours.name,
                     ink);
    else
        addLegendText(*scene, row + 1, "x, y, z of the normal: red, green, blue", ink);
    return scene;
}

void recolour(COpenGLScene& scene, Colormap colormap) {
    for (const auto& cloud : colouredClouds(scene)) {
        const auto heights = heightsOf(*cloud);
        const ValueRange range = robustRange(heights);
        for (std::size_t i = 0; i < cloud->size(); ++i) {
            const TColor c = colourAt(colormap, range.fractionAt(double{heights[i]}));
            cloud->setPointColor_u8_fast(i, c.R, c.G, c.B);
        }
        cloud->notifyChange();
    }
    recolourBar(scene, colormap);
}

void cutAbove(COpenGLScene& scene, double height) {
    for (const auto& cloud : colouredClouds(scene)) {
        const auto heights = heightsOf(*cloud);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < heights.size(); ++i)
            if (double{heights[i]} <= height) copyPoint(*cloud, i, kept++);
        cloud->resize(kept);
    }
}

COpenGLScene::Ptr trajectoryScene(const MapWays& ways, const std::string& name) {
    const auto &estimate = ways.trajectory, &groundTruth = ways.groundTruth;
    if (estimate.empty()) throw Error("the trajectory has no poses, so there is nothing to show");
    auto all = estimate;
    all.insert(all.end(), groundTruth.begin(), groundTruth.end());
    const Extent extent = extentOf(all);
    const double size_m = std::max(extent.longer(), 1.0);

    auto scene = COpenGLScene::Create();
    scene->getViewport()->setCustomBackgroundColor(TColorf(kWhite));
    addGrid(*scene, extent, size_m, TColor(60, 60, 60));
    if (!groundTruth.empty()) {
        const auto byHeight = [](const Isometry3d& a, const Isometry3d& b) {
            return a.translation().z() < b.translation().z();
        };
        const double top =
            std::max_element(groundTruth.begin(), groundTruth.end(), byHeight)->translation().z();
        const double bottom =
            std::min_element(estimate.begin(), estimate.end(), byHeight)->translation().z();
        auto below = groundTruth;
        for (auto& pose : below)
            pose.translation().z() += std::min(0.0, bottom - top - size_m / 100);
        addWay(*scene, below, size_m, kRed, 7, "ground_truth");
        addLegendText(*scene, 2, "ground truth", kRed);
    }
    addWay(*scene, estimate, size_m, kBlue, 3, "trajectory");
    addLegendText(*scene, 1, name, kBlue);
    addLoops(*scene, ways, size_m, groundTruth.empty() ? 2 : 3);
    addMark(*scene, estimate.front(), kGreen, size_m, "start");
    addMark(*scene, estimate.back(), kYellow, size_m, "end");
    addNorth(*scene, ways.north);
    return scene;
}

void saveScene(const COpenGLScene& scene, const std::string& path) { io::saveWhole(scene, path); }

COpenGLScene::Ptr loadScene(const std::string& path) {
    auto scene = COpenGLScene::Create();
    io::loadWhole(path, "a .3Dscene", io::FileOf::Scene, *scene);
    try {
        makeDrawable(*scene);
        repaintBar(*scene);
    } catch (const Error& e) {
        throw Error("'" + path + "' " + e.what());
    }
    return scene;
}
}  // namespace delio::picture
