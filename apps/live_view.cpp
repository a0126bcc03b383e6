#include "live_view.h"

#include <mrpt/gui/CDisplayWindow3D.h>
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
#include <utility>
#include <vector>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/map/colouring.h"

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
constexpr double kDrawn = 0.05;               // part of the time that drawing may take
constexpr auto kKeys = milliseconds(30);      // between looks at the keyboard
constexpr auto kScreenshot = milliseconds(3000);
constexpr const char* kHelp =
    "Space: pause   F: follow   T: view from above   S: screenshot   mouse: turn, zoom, move";
}  // namespace

struct LiveView::Window {
    explicit Window(std::shared_ptr<const LiveMap> shown)
        : source(std::move(shown)), window("DeLiO", 1280, 720) {}

    void prepare();
    void run();
    void obey(int key);
    void lookFromAbove(bool above);
    void takeScreenshot();
    /** False where nothing has changed. */
    bool show();
    void add(const LiveMap::News& news, COpenGLScene& scene);
    void addPoint(const LiveMap::Point& point, COpenGLScene& scene);

    const std::shared_ptr<const LiveMap> source;
    mrpt::gui::CDisplayWindow3D window;
    std::vector<CPointCloudColoured::Ptr> blocks;
    mrpt::opengl::CPointCloud::Ptr current = mrpt::opengl::CPointCloud::Create();
    mrpt::opengl::CSetOfLines::Ptr path = mrpt::opengl::CSetOfLines::Create();
    mrpt::opengl::CSetOfObjects::Ptr vehicle = mrpt::opengl::stock_objects::CornerXYZSimple(2, 3);
    LiveMap::Seen seen;
    std::size_t scans = 0;  //!< that the picture is of
    Eigen::Vector3f lastPlace = Eigen::Vector3f::Zero();
    bool isPaused = false, follows = true, isFromAbove = false;
    std::atomic<bool> isEnding{false};
    std::thread thread;
};

void LiveView::Window::prepare() {
    {
        COpenGLScene::Ptr scene;
        mrpt::gui::CDisplayWindow3DLocker locked(window, scene);
        scene->getViewport()->setCustomBackgroundColor({0.06F, 0.07F, 0.09F});
        scene->getViewport()->setViewportClipDistances(1, 5000);
        current->setPointSize(1);
        current->enableVariablePointSize(false);
        current->setColor_u8(TColor(255, 255, 255));
        path->setColor_u8(TColor(255, 210, 0));
        path->setLineWidth(3);
        auto grid = mrpt::opengl::CGridPlaneXY::Create(-1000, 1000, -1000, 1000, -2, 20);
        grid->setColor_u8(TColor(70, 70, 75));
        scene->insert(grid);
        scene->insert(current);
        scene->insert(path);
        scene->insert(vehicle);
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

void LiveView::Window::takeScreenshot() {
    window.captureImagesStart();
    window.repaint();
    mrpt::img::CImage image;
    const auto end = std::chrono::steady_clock::now() + kScreenshot;
    while (!window.getLastWindowImage(image) && std::chrono::steady_clock::now() < end)
        std::this_thread::sleep_for(kKeys);
    window.captureImagesStop();
    std::string file;
    for (int i = 1; file.empty() || std::filesystem::exists(file); ++i)
        file = "delio-" + std::to_string(i) + ".png";
    if (!image.isEmpty() && image.saveToFile(file))
        cli::inform("screenshot: " + std::filesystem::absolute(file).string());
    else
        cli::warn("cannot write the screenshot '" + file + "'");
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

void LiveView::Window::addPoint(const LiveMap::Point& point, COpenGLScene& scene) {
    if (blocks.empty() || blocks.back()->size() >= kBlock) {
        blocks.push_back(CPointCloudColoured::Create());
        blocks.back()->setPointSize(2);
        blocks.back()->enableVariablePointSize(false);
        scene.insert(blocks.back());
    }
    const TColor c =
        map::colourAt(map::Colormap::Turbo, kHeights.fractionAt(double{point.aboveGround}));
    const auto& at = point.position;
    blocks.back()->insertPoint({at.x(), at.y(), at.z(), c.R, c.G, c.B});
}

void LiveView::Window::add(const LiveMap::News& news, COpenGLScene& scene) {
    if (news.from.generation != seen.generation) {
        for (const auto& block : blocks) scene.removeObject(block);
        blocks.clear();
        path->clear();
    }
    for (const auto& point : news.points) addPoint(point, scene);
    for (std::size_t i = 0; i < news.trajectory.size(); ++i) {
        const Eigen::Vector3f to = news.trajectory[i];
        const Eigen::Vector3f from = news.from.poses + i == 0 ? to : lastPlace;
        path->appendLine(from.x(), from.y(), from.z(), to.x(), to.y(), to.z());
        lastPlace = to;
    }
    seen = news.seen();
    scans = news.scans;
    vehicle->setPose(toMrpt(news.vehicle));
    const Eigen::Matrix3Xf latest = source->latestScan();
    current->clear();
    for (const auto& point : latest.colwise())
        current->insertPoint(point.x(), point.y(), point.z());
}

bool LiveView::Window::show() {
    const auto news = source->newsSince(seen, kMostNews);
    if (news.scans == scans && news.points.empty() && news.from.generation == seen.generation)
        return false;
    {
        COpenGLScene::Ptr scene;
        mrpt::gui::CDisplayWindow3DLocker locked(window, scene);
        add(news, *scene);
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
