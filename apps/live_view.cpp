#include "live_view.h"

#include <mrpt/gui/CDisplayWindow3D.h>
#include <mrpt/opengl/CGridPlaneXY.h>
#include <mrpt/opengl/CPointCloud.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/stock_objects.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <set>

#include "delio/core/error.h"
#include "delio/map/colouring.h"
#include "delio/picture/figures.h"

namespace delio {
using mrpt::img::TColor;
using mrpt::opengl::COpenGLScene;
using mrpt::opengl::COpenGLViewport;

namespace {
constexpr double kMapVoxel_m = 0.4;
constexpr double kMapStep_m = 2;        // a scan goes into the shown map every so many metres
const map::ValueRange kHeights{-2, 3};  // from the sensor

/** One of the small pictures to the right. */
void addInset(COpenGLScene& scene, const std::string& name, const std::string& caption,
              double bottom) {
    const auto viewport = scene.createViewport(name);
    viewport->setViewportPosition(0.7, bottom, 0.29, 0.48);
    viewport->setCustomBackgroundColor({1, 1, 1});
    viewport->setBorderSize(1);
    mrpt::opengl::TFontParams font;
    font.vfont_name = "sans";
    font.vfont_scale = 13;
    font.color = {0.15F, 0.15F, 0.15F};
    viewport->addTextMessage(10, 10, caption, 1, font);
}

void replaceContent(COpenGLViewport& viewport, const COpenGLScene& by) {
    viewport.clear();
    for (const auto& object : *by.getViewport()) viewport.insert(object);
}

void setCamera(COpenGLViewport& viewport, float azimuth_deg, float elevation_deg, float across_m) {
    auto& camera = viewport.getCamera();
    camera.setOrthogonal(true);
    camera.setAzimuthDegrees(azimuth_deg);
    camera.setElevationDegrees(elevation_deg);
    camera.setPointingAt(0, 0, 0);
    camera.setZoomDistance(across_m);
}
}  // namespace

struct LiveView::Window {
    explicit Window(const PaperOdometryOptions& o)
        : options(o), stages(o), window("DeLiO", 1280, 800) {}

    void prepare();
    void showInsets(const Scan& scan, const Eigen::Isometry3d& increment, COpenGLScene& scene);
    void showMap(const Scan& scan, const Eigen::Isometry3d& pose, COpenGLScene& scene);

    PaperOdometryOptions options;
    picture::PaperStages stages;
    mrpt::gui::CDisplayWindow3D window;
    mrpt::opengl::CPointCloudColoured::Ptr map = mrpt::opengl::CPointCloudColoured::Create();
    mrpt::opengl::CPointCloud::Ptr current = mrpt::opengl::CPointCloud::Create();
    mrpt::opengl::CSetOfLines::Ptr way = mrpt::opengl::CSetOfLines::Create();
    mrpt::opengl::CSetOfObjects::Ptr vehicle = mrpt::opengl::stock_objects::CornerXYZSimple(2, 3);
    std::set<std::array<long, 3>> taken;  //!< voxels that have a point of the shown map
    Eigen::Isometry3d lastMapped = Eigen::Isometry3d::Identity(), last = lastMapped;
    bool first = true;
};

void LiveView::Window::prepare() {
    COpenGLScene::Ptr scene;
    mrpt::gui::CDisplayWindow3DLocker locked(window, scene);
    scene->getViewport()->setCustomBackgroundColor({0.06F, 0.07F, 0.09F});
    scene->getViewport()->setViewportClipDistances(1, 5000);
    map->setPointSize(2);
    map->enableVariablePointSize(false);
    current->setPointSize(1);
    current->enableVariablePointSize(false);
    current->setColor_u8(TColor(255, 255, 255));
    way->setColor_u8(TColor(255, 210, 0));
    way->setVerticesPointSize(4);
    way->enableVariablePointSize(false);
    auto grid = mrpt::opengl::CGridPlaneXY::Create(-1000, 1000, -1000, 1000, -2, 20);
    grid->setColor_u8(TColor(70, 70, 75));
    scene->insert(grid);
    scene->insert(map);
    scene->insert(current);
    scene->insert(way);
    scene->insert(vehicle);
    addInset(*scene, "sphere", "pattern of normals", 0.51);
    addInset(*scene, "lines", "matched lines of two scans", 0.01);
    setCamera(*scene->getViewport("sphere"), 180, 25, 5);
    setCamera(*scene->getViewport("lines"), 180, 90, 90);
    window.setCameraAzimuthDeg(180);
    window.setCameraElevationDeg(40);
    window.setCameraZoom(90);
    window.addTextMessage(0.01, 0.02, "map, current scan (white), trajectory (yellow)");
}

void LiveView::Window::showInsets(const Scan& scan, const Eigen::Isometry3d& increment,
                                  COpenGLScene& scene) {
    const auto drawn = stages.add(scan, increment);
    replaceContent(*scene.getViewport("sphere"), *drawn.pattern);
    if (drawn.matches) replaceContent(*scene.getViewport("lines"), *drawn.matches);
}

void LiveView::Window::showMap(const Scan& scan, const Eigen::Isometry3d& pose, COpenGLScene&) {
    const Eigen::Isometry3d sensor = pose * scan.sensorPose;
    current->loadFromPointsMap(scan.points.get());
    current->setPose(toMrpt(sensor));
    vehicle->setPose(toMrpt(pose));
    if (!first) way->appendLine(toMrpt(last).translation(), toMrpt(pose).translation());
    last = pose;
    if (!first && (pose.translation() - lastMapped.translation()).norm() < kMapStep_m) return;
    lastMapped = pose;
    const auto& x = scan.points->getPointsBufferRef_x();
    const auto& y = scan.points->getPointsBufferRef_y();
    const auto& z = scan.points->getPointsBufferRef_z();
    const double least = options.scan.min_range, most = options.scan.max_range;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Eigen::Vector3d p(double{x[i]}, double{y[i]}, double{z[i]});
        if (!(p.norm() >= least && p.norm() <= most)) continue;
        const Eigen::Vector3d q = sensor * p;
        const auto cell = [&](int axis) { return std::lround(q[axis] / kMapVoxel_m); };
        if (!taken.insert({cell(0), cell(1), cell(2)}).second) continue;
        const TColor c = map::colourAt(map::Colormap::Turbo,
                                       kHeights.fractionAt(q.z() - sensor.translation().z()));
        map->insertPoint({static_cast<float>(q.x()), static_cast<float>(q.y()),
                          static_cast<float>(q.z()), c.R, c.G, c.B});
    }
}

LiveView::LiveView(const PaperOdometryOptions& options) {
    // MRPT would wait for a while and then go on without a window.
    const char* display = std::getenv("DISPLAY");
    if (!display || !*display)
        throw Error("--gui needs a display, but DISPLAY is not set; leave out --gui");
    window_ = std::make_unique<Window>(options);
    if (!window_->window.isOpen())
        throw Error("--gui cannot open a window on display '" + std::string(display) +
                    "'; leave out --gui");
    window_->prepare();
}

// The window is left to the end of the program: taken away earlier, MRPT 2.5.8's window thread may
// still be drawing it.
LiveView::~LiveView() { static_cast<void>(window_.release()); }

void LiveView::add(const SlamScan& told) {
    if (!isOpen()) return;
    {
        COpenGLScene::Ptr scene;
        mrpt::gui::CDisplayWindow3DLocker locked(window_->window, scene);
        window_->showInsets(told.scan, told.step.increment.pose, *scene);
        window_->showMap(told.scan, told.pose, *scene);
    }
    window_->first = false;
    const Eigen::Vector3f at = told.pose.translation().cast<float>();
    window_->window.setCameraPointingToPoint(at.x(), at.y(), at.z());
    window_->window.repaint();
}

bool LiveView::isOpen() const { return window_->window.isOpen(); }
}  // namespace delio
