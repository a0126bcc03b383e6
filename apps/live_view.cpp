#include "live_view.h"

#include <mrpt/gui/CDisplayWindow3D.h>
#include <mrpt/opengl/CFBORender.h>
#include <mrpt/opengl/CGridPlaneXY.h>
#include <mrpt/opengl/CPointCloud.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/stock_objects.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <utility>
#include <vector>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/map/colouring.h"
#include "delio/picture/render.h"

namespace delio {
using mrpt::img::TColor;
using mrpt::opengl::COpenGLScene;
using mrpt::opengl::CPointCloudColoured;
using std::chrono::milliseconds;

namespace {
const map::ValueRange kHeights{0, 6};         // metres above the ground, of the colours
constexpr std::size_t kBlock = 50000;         // points that go to the graphics card together
constexpr std::size_t kMostNews = 200000;     // points between two pictures
constexpr auto kFastest = milliseconds(100);  // from picture to picture
constexpr double kDrawn = 0.02;               // part of the time that drawing may take
constexpr auto kKeys = milliseconds(30);      // between looks at the keyboard
constexpr unsigned kWidth_px = 1280, kHeight_px = 720;
constexpr float kWeak_m = 6;  // the line of a weak axis, to either side
constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
constexpr const char* kHelp =
    "Space: pause   F: follow   T: view from above   S: screenshot   mouse: turn, zoom, move";

/** What is drawn. */
class LiveScene {
 public:
    void insertInto(COpenGLScene& scene);
    void add(const LiveMap::News& news, const Eigen::Matrix3Xf& latestScan, COpenGLScene& scene);

    const LiveMap::Seen& seen() const { return seen_; }
    std::size_t scans() const { return scans_; }

 private:
    void addPoint(const LiveMap::Point& point, COpenGLScene& scene);

    std::vector<CPointCloudColoured::Ptr> blocks_;
    mrpt::opengl::CPointCloud::Ptr current_ = mrpt::opengl::CPointCloud::Create();
    mrpt::opengl::CSetOfLines::Ptr path_ = mrpt::opengl::CSetOfLines::Create();
    mrpt::opengl::CSetOfLines::Ptr weak_ = mrpt::opengl::CSetOfLines::Create();
    mrpt::opengl::CSetOfObjects::Ptr vehicle_ = mrpt::opengl::stock_objects::CornerXYZSimple(2, 3);
    LiveMap::Seen seen_;
    std::size_t scans_ = 0;
    Eigen::Vector3f lastPlace_ = Eigen::Vector3f::Zero();
};

void LiveScene::insertInto(COpenGLScene& scene) {
    scene.getViewport()->setCustomBackgroundColor({0.06F, 0.07F, 0.09F});
    scene.getViewport()->setViewportClipDistances(1, 5000);
    current_->setPointSize(1);
    current_->enableVariablePointSize(false);
    current_->setColor_u8(TColor(255, 255, 255));
    path_->setColor_u8(TColor(255, 210, 0));
    path_->setLineWidth(3);
    weak_->setColor_u8(TColor(255, 64, 200));
    weak_->setLineWidth(5);
    auto grid = mrpt::opengl::CGridPlaneXY::Create(-1000, 1000, -1000, 1000, -2, 20);
    grid->setColor_u8(TColor(70, 70, 75));
    scene.insert(grid);
    scene.insert(current_);
    scene.insert(path_);
    scene.insert(weak_);
    scene.insert(vehicle_);
}

void LiveScene::addPoint(const LiveMap::Point& point, COpenGLScene& scene) {
    if (blocks_.empty() || blocks_.back()->size() >= kBlock) {
        blocks_.push_back(CPointCloudColoured::Create());
        blocks_.back()->setPointSize(2);
        blocks_.back()->enableVariablePointSize(false);
        scene.insert(blocks_.back());
    }
    const TColor c =
        map::colourAt(map::Colormap::Turbo, kHeights.fractionAt(double{point.aboveGround}));
    const auto& at = point.position;
    blocks_.back()->insertPoint({at.x(), at.y(), at.z(), c.R, c.G, c.B});
}

void LiveScene::add(const LiveMap::News& news, const Eigen::Matrix3Xf& latestScan,
                    COpenGLScene& scene) {
    if (news.from.generation != seen_.generation) {
        for (const auto& block : blocks_) scene.removeObject(block);
        blocks_.clear();
        path_->clear();
    }
    for (const auto& point : news.points) addPoint(point, scene);
    for (std::size_t i = 0; i < news.trajectory.size(); ++i) {
        const Eigen::Vector3f to = news.trajectory[i];
        const Eigen::Vector3f from = news.from.poses + i == 0 ? to : lastPlace_;
        path_->appendLine(from.x(), from.y(), from.z(), to.x(), to.y(), to.z());
        lastPlace_ = to;
    }
    seen_ = news.seen();
    scans_ = news.scans;
    vehicle_->setPose(toMrpt(news.vehicle));
    weak_->clear();
    const Eigen::Vector3f at = news.vehicle.translation().cast<float>();
    for (const auto& axis : news.weakAxes.colwise()) {
        const Eigen::Vector3f from = at - kWeak_m * axis, to = at + kWeak_m * axis;
        weak_->appendLine(from.x(), from.y(), from.z(), to.x(), to.y(), to.z());
    }
    current_->clear();
    for (const auto& point : latestScan.colwise())
        current_->insertPoint(point.x(), point.y(), point.z());
}
}  // namespace

struct LiveView::Window {
    explicit Window(std::shared_ptr<const LiveMap> shown)
        : source(std::move(shown)), window("DeLiO", kWidth_px, kHeight_px) {}

    void prepare();
    void run();
    void obey(int key);
    void lookFromAbove(bool above);
    mrpt::img::CImage picture() const;
    void takeScreenshot() const;
    /** False where nothing has changed. */
    bool show();

    const std::shared_ptr<const LiveMap> source;
    mrpt::gui::CDisplayWindow3D window;
    LiveScene drawn;
    bool isPaused = false, follows = true, isFromAbove = false;
    std::atomic<bool> isEnding{false};
    std::thread thread;
};

void LiveView::Window::prepare() {
    {
        COpenGLScene::Ptr scene;
        mrpt::gui::CDisplayWindow3DLocker locked(window, scene);
        drawn.insertInto(*scene);
    }
    window.setCameraZoom(90);
    lookFromAbove(false);
    window.addTextMessage(0.01, 0.02, kHelp);
    thread = std::thread([this] { run(); });
}

void LiveView::Window::lookFromAbove(bool above) {
    isFromAbove = above;
    window.setCameraProjective(!above);
    window.setCameraAzimuthDeg(above ? -90 : 180);
    window.setCameraElevationDeg(above ? 90 : 40);
}

/** Drawn anew: where there is no screen, what a window shows cannot be read. */
mrpt::img::CImage LiveView::Window::picture() const {
    COpenGLScene scene;
    LiveScene content;
    content.insertInto(scene);
    content.add(source->newsSince({}, kAll), source->latestScan(), scene);
    mrpt::opengl::CCamera camera;
    float x = 0, y = 0, z = 0;
    window.getCameraPointingToPoint(x, y, z);
    camera.setPointingAt(x, y, z);
    camera.setAzimuthDegrees(window.getCameraAzimuthDeg());
    camera.setElevationDegrees(window.getCameraElevationDeg());
    camera.setZoomDistance(window.getCameraZoom());
    camera.setOrthogonal(!window.isCameraProjective());
    mrpt::img::CImage image(kWidth_px, kHeight_px);
    mrpt::opengl::CFBORender renderer(kWidth_px, kHeight_px);
    renderer.setCamera(scene, camera);
    renderer.render_RGB(scene, image);
    // Buffers and shaders belong to the context that is about to go.
    scene.unloadShaders();
    scene.freeOpenGLResources();
    return image;
}

void LiveView::Window::takeScreenshot() const {
    std::string file;
    for (int i = 1; file.empty() || std::filesystem::exists(file); ++i)
        file = "delio-" + std::to_string(i) + ".png";
    try {
        picture::savePng(picture(), file);
        cli::inform("screenshot: " + std::filesystem::absolute(file).string());
    } catch (const std::exception& e) {
        cli::warn("no screenshot: " + plainMessage(e));
    }
}

void LiveView::Window::obey(int key) {
    switch (key) {
        case ' ':
            isPaused = !isPaused;
            window.addTextMessage(0.01, 0.07, isPaused ? "paused (space goes on)" : "", 1);
            break;
        case 'f':
        case 'F':
            follows = !follows;
            break;
        case 't':
        case 'T':
            lookFromAbove(!isFromAbove);
            break;
        case 's':
        case 'S':
            takeScreenshot();
            break;
        default:
            return;
    }
    window.repaint();
}

bool LiveView::Window::show() {
    const auto& seen = drawn.seen();
    const auto news = source->newsSince(seen, kMostNews);
    if (news.scans == drawn.scans() && news.points.empty() &&
        news.from.generation == seen.generation)
        return false;
    {
        COpenGLScene::Ptr scene;
        mrpt::gui::CDisplayWindow3DLocker locked(window, scene);
        drawn.add(news, source->latestScan(), *scene);
    }
    if (!follows) return true;
    const Eigen::Vector3f at = news.vehicle.translation().cast<float>();
    window.setCameraPointingToPoint(at.x(), at.y(), at.z());
    return true;
}

void LiveView::Window::run() {
    using Clock = std::chrono::steady_clock;
    Clock::time_point next = Clock::now();
    while (!isEnding && window.isOpen()) {
        if (window.keyHit()) obey(window.getPushedKey());
        if (Clock::now() >= next && !isPaused) {
            const auto begin = Clock::now();
            if (show()) window.repaint();
            // With a graphics card a picture takes some milliseconds, without one many.
            const std::chrono::duration<double> drawing(1 /
                                                        std::max(0.1, window.getRenderingFPS()));
            const auto rest = (drawing + (Clock::now() - begin)) / kDrawn;
            next = begin + std::max<Clock::duration>(
                               kFastest, std::chrono::duration_cast<Clock::duration>(rest));
        }
        std::this_thread::sleep_for(kKeys);
    }
}

LiveView::LiveView(std::shared_ptr<const LiveMap> map) {
    // MRPT would wait for a while and then go on without a window.
    const char* display = std::getenv("DISPLAY");
    if (!display || !*display)
        throw Error("--gui needs a display, but DISPLAY is not set; leave out --gui");
    window_ = std::make_unique<Window>(std::move(map));
    if (!window_->window.isOpen())
        throw Error("--gui cannot open a window on display '" + std::string(display) +
                    "'; leave out --gui");
    window_->prepare();
}

// The window is left to the end of the program: taken away earlier, MRPT 2.5.8's window thread may
// still be drawing it.
LiveView::~LiveView() {
    window_->isEnding = true;
    if (window_->thread.joinable()) window_->thread.join();
    static_cast<void>(window_.release());
}

bool LiveView::isOpen() const { return window_->window.isOpen(); }
}  // namespace delio
