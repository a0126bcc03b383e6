#include "delio/map/snapshot.h"

#include <mrpt/io/CMemoryStream.h>
#include <mrpt/opengl/CCamera.h>
#include <mrpt/opengl/CFBORender.h>
#include <mrpt/opengl/CGridPlaneXY.h>
#include <mrpt/opengl/CPointCloud.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/poses/CPose3D.h>
#include <mrpt/serialization/CArchive.h>
#include <png.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>

#include "delio/error.h"
#include "delio/io/output_file.h"
#include "round_length.h"

namespace delio::map {
namespace fs = std::filesystem;
using Eigen::Vector3d;
using mrpt::img::CImage;
using mrpt::img::TColorf;
using mrpt::opengl::CFBORender;
using mrpt::opengl::COpenGLScene;
using mrpt::opengl::CRenderizable;

namespace {
constexpr double kVerticalView_deg = 30;
constexpr double kMargin = 1.05;  // the content fills the picture but for this
constexpr std::size_t kMaxSamples = 200000;

/** Places of the scene that the picture has to show. */
struct Content {
    std::vector<Vector3d> points;  //!< a few of which may be strays
    std::vector<Vector3d> lines;   //!< ends of lines: none is left out
    std::vector<Vector3d> grids;   //!< corners: shown where they fall into the picture
    bool empty() const { return points.empty() && lines.empty(); }
};

template <typename Cloud>
void sample(const Cloud& cloud, const mrpt::poses::CPose3D& pose, std::vector<Vector3d>& to) {
    const std::size_t step = cloud.size() / kMaxSamples + 1;
    for (std::size_t i = 0; i < cloud.size(); i += step) {
        const auto& p = cloud.getPoint3Df(i);
        const auto q = pose.composePoint(mrpt::math::TPoint3D(p));
        if (std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z))
            to.emplace_back(q.x, q.y, q.z);
    }
}

/** Corners of the box around an object: for what is neither points nor lines. */
void addBox(const CRenderizable& object, const mrpt::poses::CPose3D& pose,
            std::vector<Vector3d>& to) {
    const auto box = object.getBoundingBoxLocal();
    for (int corner = 0; corner < 8; ++corner) {
        const auto at = pose.composePoint(mrpt::math::TPoint3D(corner & 1 ? box.max.x : box.min.x,
                                                               corner & 2 ? box.max.y : box.min.y,
                                                               corner & 4 ? box.max.z : box.min.z));
        if (std::isfinite(at.norm())) to.emplace_back(at.x, at.y, at.z);
    }
}

void collect(const CRenderizable::Ptr& object, const mrpt::poses::CPose3D& parent,
             Content& content) {
    const mrpt::poses::CPose3D pose = parent + mrpt::poses::CPose3D(object->getPose());
    if (!object->isVisible()) return;
    if (const auto set = std::dynamic_pointer_cast<mrpt::opengl::CSetOfObjects>(object)) {
        for (const auto& child : *set) collect(child, pose, content);
    } else if (const auto c =
                   std::dynamic_pointer_cast<mrpt::opengl::CPointCloudColoured>(object)) {
        sample(*c, pose, content.points);
    } else if (const auto p = std::dynamic_pointer_cast<mrpt::opengl::CPointCloud>(object)) {
        sample(*p, pose, content.points);
    } else if (const auto l = std::dynamic_pointer_cast<mrpt::opengl::CSetOfLines>(object)) {
        const auto& lines = *l;  // const: a change would be noted otherwise
        const std::size_t step = lines.size() / kMaxSamples + 1;
        for (std::size_t i = 0; i < lines.size(); i += step) {
            const auto& line = lines.begin()[static_cast<std::ptrdiff_t>(i)];
            for (const auto& end : {line.point1, line.point2}) {
                const auto q = pose.composePoint(end);
                if (std::isfinite(q.norm())) content.lines.emplace_back(q.x, q.y, q.z);
            }
        }
    } else if (std::dynamic_pointer_cast<mrpt::opengl::CGridPlaneXY>(object)) {
        addBox(*object, pose, content.grids);
    } else if (!std::dynamic_pointer_cast<mrpt::opengl::CCamera>(object)) {
        addBox(*object, pose, content.lines);
    }
}

Content contentOf(const COpenGLScene& scene) {
    Content content;
    for (const auto& object : *scene.getViewport()) collect(object, {}, content);
    return content;
}

/** Smallest and largest value, of points without the outermost half percent on either side. */
template <typename Value>
std::pair<double, double> span(const Content& content, const Value& value) {
    double low = std::numeric_limits<double>::max(), high = -low;
    if (!content.points.empty()) {
        std::vector<double> values;
        values.reserve(content.points.size());
        for (const auto& p : content.points) values.push_back(value(p));
        const auto last = static_cast<double>(values.size() - 1);
        const auto at = [&](double share) {
            const auto it = values.begin() + std::lround(share * last);
            std::nth_element(values.begin(), it, values.end());
            return *it;
        };
        low = at(0.005);
        high = at(0.995);
    }
    for (const auto& p : content.lines) {
        low = std::min(low, value(p));
        high = std::max(high, value(p));
    }
    return {low, high};
}

/** Azimuth that lays the longer horizontal side of the content across the picture. Seen straight
 *  from above only by right angles, so that the grid stays straight. */
double acrossAzimuth_deg(const Content& content, bool fromAbove) {
    const auto& places = content.points.size() > 100 ? content.points : content.lines;
    if (fromAbove) {
        const auto [xMin, xMax] = span(content, [](const Vector3d& p) { return p.x(); });
        const auto [yMin, yMax] = span(content, [](const Vector3d& p) { return p.y(); });
        return xMax - xMin >= yMax - yMin ? -90 : 180;
    }
    Eigen::Vector2d mean(0, 0);
    Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
    for (const auto& p : places) mean += p.head<2>();
    mean /= static_cast<double>(std::max<std::size_t>(places.size(), 1));
    for (const auto& p : places) scatter += (p.head<2>() - mean) * (p.head<2>() - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(scatter);
    const Eigen::Vector2d across = axes.eigenvectors().col(1);
    const double azimuth = mrpt::RAD2DEG(std::atan2(across.x(), -across.y()));
    // One of the two sides, always the same one: that of -y, so that +x points right.
    return azimuth > 0 ? azimuth - 180 : azimuth;
}

struct View {
    Vector3d right, up, back;  //!< axes of the camera in the world; back: from content to camera
    Vector3d middle;
    double distance = 1;               //!< of the camera from the middle
    double metresAcross = 1;           //!< at the middle
    double magnification = 1;          //!< by zoom_m, beyond what shows everything
    double nearest = 0, farthest = 0;  //!< depth of the whole content, from the camera
};

std::function<double(const Vector3d&)> along(const Vector3d& axis) {
    return [axis](const Vector3d& p) { return axis.dot(p); };
}

View viewFrom(double azimuth_deg, double elevation_deg) {
    View view;
    const double az = mrpt::DEG2RAD(azimuth_deg), el = mrpt::DEG2RAD(elevation_deg);
    view.right = {-std::sin(az), std::cos(az), 0};
    view.back = {std::cos(az) * std::cos(el), std::sin(az) * std::cos(el), std::sin(el)};
    view.up = view.back.cross(view.right);
    return view;
}

/** Half of what is seen at a distance of 1. */
struct Lens {
    explicit Lens(const SnapshotOptions& options)
        : aspect(double(options.width_px) / options.height_px),
          tanY(std::tan(mrpt::DEG2RAD(kVerticalView_deg) / 2)),
          tanX(tanY * aspect) {}
    double aspect, tanY, tanX;
};

/** Distance from the view's middle from which all content is seen in perspective. */
double distanceFor(const Content& content, const View& view, const Lens& lens) {
    const auto needed = [&](const Vector3d& p) {
        const Vector3d q = p - view.middle;
        return view.back.dot(q) + std::max(std::abs(view.right.dot(q)) / lens.tanX,
                                           std::abs(view.up.dot(q)) / lens.tanY);
    };
    return std::max(span(content, needed).second, 0.2) * kMargin;
}

/** Lets the content fill the picture. */
void frame(View& view, const Content& content, const SnapshotOptions& options) {
    const Lens lens(options);
    const auto [left, right] = span(content, along(view.right));
    const auto [bottom, top] = span(content, along(view.up));
    const auto [behind, front] = span(content, along(view.back));
    view.middle = view.right * (left + right) / 2 + view.up * (bottom + top) / 2 +
                  view.back * (behind + front) / 2;
    view.metresAcross = std::max({right - left, (top - bottom) * lens.aspect, 0.1}) * kMargin;
    if (options.ortho) return;
    // Perspective moves what is near outwards: step back until everything fits, centre, repeat.
    for (int round = 0; round < 4; ++round) {
        view.distance = distanceFor(content, view, lens);
        for (const Vector3d& axis : {view.right, view.up}) {
            const auto [low, high] = span(content, [&](const Vector3d& p) {
                const Vector3d q = p - view.middle;
                return axis.dot(q) / std::max(view.distance - view.back.dot(q), 0.1);
            });
            view.middle += axis * (low + high) / 2 * view.distance;
        }
    }
    view.metresAcross = 2 * lens.tanX * view.distance;
}

/** Lets the content fit into every one of the views, all about one middle and of one size. */
void frameAll(std::vector<View>& views, const Content& content, const SnapshotOptions& options) {
    const Lens lens(options);
    Vector3d middle;
    for (int axis = 0; axis < 3; ++axis) {
        const auto [low, high] = span(content, along(Vector3d::Unit(axis)));
        middle[axis] = (low + high) / 2;
    }
    double metresAcross = 0.1;
    for (auto& view : views) {
        view.middle = middle;
        double across = 2 * lens.tanX * distanceFor(content, view, lens);
        if (options.ortho) {
            const auto [least, most] = span(content, [&](const Vector3d& p) {
                const Vector3d q = p - middle;
                return std::max(std::abs(view.right.dot(q)),
                                std::abs(view.up.dot(q)) * lens.aspect);
            });
            across = 2 * most * kMargin;
        }
        metresAcross = std::max(metresAcross, across);
    }
    for (auto& view : views) view.metresAcross = metresAcross;
}

void setDepths(View& view, const Content& content, const SnapshotOptions& options) {
    if (options.zoom_m) {
        view.magnification = view.metresAcross / *options.zoom_m;
        view.metresAcross = *options.zoom_m;
    }
    view.distance = view.metresAcross / (2 * Lens(options).tanX);
    // Strays do not count here either: MRPT keeps the camera's place in floats, so a camera that
    // stands far off looks past its content.
    const auto height = [&](const Vector3d& p) { return view.back.dot(p - view.middle); };
    auto [deepest, closest] = span(content, height);
    for (const auto& p : content.grids) {
        deepest = std::min(deepest, height(p));
        closest = std::max(closest, height(p));
    }
    const double slack = 10 + 0.5 * (closest - deepest);
    // In parallel projection the camera's distance shows nowhere: let it be in front of everything.
    if (options.ortho) view.distance = std::max(view.distance, closest + 2 * slack);
    view.nearest = view.distance - closest - slack;
    view.farthest = view.distance - deepest + slack;
}

/** `pictures` views around the content; one fills the picture as well as it can. */
std::vector<View> viewsOf(const Content& content, const SnapshotOptions& options,
                          unsigned pictures) {
    const double first = options.azimuth_deg
                             ? *options.azimuth_deg
                             : acrossAzimuth_deg(content, options.elevation_deg == 90);
    std::vector<View> views;
    for (unsigned i = 0; i < pictures; ++i)
        views.push_back(viewFrom(first + 360.0 * i / pictures, options.elevation_deg));
    if (pictures == 1)
        frame(views[0], content, options);
    else
        frameAll(views, content, options);
    for (auto& view : views) setDepths(view, content, options);
    return views;
}

mrpt::opengl::CCamera cameraOf(const View& view, double metresAcross, double aspect, bool ortho) {
    mrpt::opengl::CCamera camera;
    Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
    // MRPT's camera looks along +z, its y points down.
    pose.block<3, 1>(0, 0) = view.right;
    pose.block<3, 1>(0, 1) = -view.up;
    pose.block<3, 1>(0, 2) = -view.back;
    pose.block<3, 1>(0, 3) = view.middle + view.back * view.distance;
    camera.set6DOFMode(true);
    camera.setPose(mrpt::poses::CPose3D(mrpt::math::CMatrixDouble44(pose)));
    camera.setOrthogonal(ortho);
    camera.setProjectiveFOVdeg(static_cast<float>(kVerticalView_deg));
    // MRPT shows half of this "distance" across the shorter side of a parallel projection.
    camera.setZoomDistance(static_cast<float>(2 * metresAcross / std::max(aspect, 1.0)));
    return camera;
}

double lightness(const TColorf& c) { return 0.3 * c.R + 0.6 * c.G + 0.1 * c.B; }

/** How much larger than in a picture of 1080 lines marks, texts and points are. */
double sizeOfMarks(const SnapshotOptions& options) {
    const double lines = std::min(options.width_px / 16.0 * 9, double(options.height_px));
    return std::clamp(lines / 1080, 0.6, 4.0);
}

/** Smaller pictures have no room for a legend. */
bool hasLegend(const SnapshotOptions& options) {
    return options.width_px >= 480 && options.height_px >= 320;
}

/** A bar of a round length, white or black, whatever is on the ground there. */
struct ScaleBar {
    ScaleBar(const View& view, const SnapshotOptions& options) {
        const double length_m = roundLength(view.metresAcross / 8);
        const double marks = sizeOfMarks(options);
        width_px = static_cast<int>(std::lround(length_m / view.metresAcross * options.width_px));
        height_px = static_cast<int>(std::lround(6 * marks));
        right_px = static_cast<int>(options.width_px) - static_cast<int>(25 * marks);
        bottom_px = static_cast<int>(options.height_px) - static_cast<int>(25 * marks);
        text = metresText(length_m);
    }
    void drawInto(CImage& image, const mrpt::img::TColor& ink) const {
        image.filledRectangle(right_px - width_px, bottom_px - height_px, right_px, bottom_px, ink);
    }
    int width_px, height_px, right_px, bottom_px;
    std::string text;
};

/** What rendering changes in a scene, put back when it is over. Sizes in pixels (points, text) are
 *  multiplied, as the picture is rendered larger than it is wanted. */
class PreparedScene {
 public:
    PreparedScene(COpenGLScene& scene, const SnapshotOptions& options, float enlarged,
                  double magnification)
        : scene_(scene),
          viewport_(scene.getViewport()),
          options_(options),
          enlarged_(enlarged),
          marks_(static_cast<float>(sizeOfMarks(options)) * enlarged) {
        viewport_->getViewportClipDistances(clipNear_, clipFar_);
        background_ = viewport_->getCustomBackgroundColor();
        if (options.background) viewport_->setCustomBackgroundColor(TColorf(*options.background));
        const float wider = std::max(marks_, enlarged);
        // From near, the gaps between points grow: let the points grow as well.
        const float nearer = static_cast<float>(std::clamp(std::sqrt(magnification), 1.0, 3.0));
        scene_.visitAllObjects([&](const CRenderizable::Ptr& object) {
            const auto points =
                std::dynamic_pointer_cast<mrpt::opengl::CRenderizableShaderPoints>(object);
            if (!points) return;
            sizes_.push_back(
                {points, points->getPointSize(), points->isEnabledVariablePointSize()});
            // MRPT would draw huge squares wherever a point's depth in clip space is about 0.
            points->enableVariablePointSize(false);
            const bool isCloud = !std::dynamic_pointer_cast<mrpt::opengl::CSetOfLines>(object) &&
                                 object->getName() != "start" && object->getName() != "end";
            if (isCloud && options.pointSize_px)
                points->setPointSize(*options.pointSize_px * enlarged);
            else
                points->setPointSize(points->getPointSize() * (isCloud ? wider * nearer : marks_));
        });
        texts_ = viewport_->getTextMessages().messages;
        constexpr double kNothing = 1e-9;  // a share of the picture; MRPT does not take 0
        for (const auto& viewport : scene_.viewports()) {
            if (viewport == viewport_) continue;
            auto& kept =
                others_.emplace_back(viewport, std::make_unique<mrpt::io::CMemoryStream>());
            mrpt::serialization::archiveFrom(*kept.second) << *viewport;
            double x = 0, y = 0, w = 0, h = 0;
            viewport->getViewportPosition(x, y, w, h);
            if (hasLegend(options))
                viewport->setViewportPosition(larger(x), larger(y), larger(w), larger(h));
            else
                viewport->setViewportPosition(0, 0, kNothing, kNothing);
        }
    }
    ~PreparedScene() {
        viewport_->setViewportClipDistances(clipNear_, clipFar_);
        viewport_->setCustomBackgroundColor(background_);
        for (const auto& [points, size, variable] : sizes_) {
            points->setPointSize(size);
            points->enableVariablePointSize(variable);
        }
        // MRPT would keep the textures of these, too, of a context that is gone.
        for (const auto& [viewport, kept] : others_) {
            kept->Seek(0);
            mrpt::serialization::archiveFrom(*kept) >> *viewport;
        }
        viewport_->clearTextMessages();
        for (const auto& [id, text] : texts_)
            viewport_->addTextMessage(text.x, text.y, text.text, id, text);
        // Buffers and shaders belong to the context that is about to go.
        scene_.unloadShaders();
        scene_.freeOpenGLResources();
        // MRPT does not notice by itself that it has to make them anew for the next picture.
        scene_.visitAllObjects([](const CRenderizable::Ptr& object) { object->notifyChange(); });
    }
    PreparedScene(const PreparedScene&) = delete;
    PreparedScene& operator=(const PreparedScene&) = delete;

    void lookFrom(const View& view) {
        const double nearClip = std::max(view.nearest, 1e-3 * view.farthest);
        viewport_->setViewportClipDistances(static_cast<float>(nearClip),
                                            static_cast<float>(view.farthest));
    }

    void showTexts(const std::optional<ScaleBar>& bar) {
        viewport_->clearTextMessages();
        if (!hasLegend(options_)) return;
        for (const auto& [id, text] : texts_) {
            mrpt::opengl::TFontParams font = text;
            font.vfont_scale *= marks_;
            // On another background than the scene's own, a text must not vanish.
            const double behind = lightness(viewport_->getCustomBackgroundColor());
            if (std::abs(lightness(font.color) - behind) < 0.3) font.color = TColorf(ink());
            viewport_->addTextMessage(larger(text.x), larger(text.y), text.text, id, font);
        }
        if (!bar) return;
        mrpt::opengl::TFontParams font;
        font.vfont_name = "sans";
        font.vfont_scale = 14.0F * marks_;
        font.color = TColorf(ink());
        constexpr unsigned kId = 1000;
        const double above = options_.height_px - bar->bottom_px + 2.5 * bar->height_px;
        viewport_->addTextMessage((bar->right_px - bar->width_px) * double{enlarged_},
                                  above * double{enlarged_}, bar->text, kId, font);
    }

    /** Stands out against the background. */
    mrpt::img::TColor ink() const {
        const bool dark = lightness(viewport_->getCustomBackgroundColor()) < 0.5;
        return dark ? mrpt::img::TColor(255, 255, 255) : mrpt::img::TColor(0, 0, 0);
    }

 private:
    /** From 1 on it is pixels, below a share of the picture. */
    double larger(double v) const { return v >= 1 ? v * double{marks_} : v; }

    COpenGLScene& scene_;
    mrpt::opengl::COpenGLViewport::Ptr viewport_;
    const SnapshotOptions& options_;
    float enlarged_, marks_;
    float clipNear_ = 0, clipFar_ = 0;
    TColorf background_;
    struct Size {
        std::shared_ptr<mrpt::opengl::CRenderizableShaderPoints> points;
        float pixels;
        bool variable;
    };
    std::vector<Size> sizes_;
    std::vector<
        std::pair<mrpt::opengl::COpenGLViewport::Ptr, std::unique_ptr<mrpt::io::CMemoryStream>>>
        others_;
    std::map<uint32_t, mrpt::opengl::CTextMessageCapable::DataPerText> texts_;
};

/** The first EGL device that can be used: where there is a GPU that this user may not open, a later
 *  one is the software renderer. */
std::unique_ptr<CFBORender> openRenderer(unsigned width, unsigned height) {
    constexpr int kDevicesTried = 8;
    for (int device = 0; device < kDevicesTried; ++device) {
        CFBORender::Parameters parameters(width, height);
        parameters.deviceIndexToUse = device;
        try {
            return std::make_unique<CFBORender>(parameters);
        } catch (const std::exception&) {
            // Try the next one.
        }
    }
    throw Error(
        "cannot render: no EGL device can be used; install libegl1 and libgl1-mesa-dri (no display "
        "is needed)");
}
}  // namespace

SnapshotOptions topView() {
    SnapshotOptions options;
    options.elevation_deg = 90;
    options.ortho = true;
    options.scaleBar = true;
    return options;
}

void orbit(COpenGLScene& scene, const SnapshotOptions& options, unsigned pictures,
           const std::function<void(unsigned, const CImage&)>& use) {
    const auto sizeIsGood = [](unsigned px) { return px >= 1 && px <= kMaxPictureSize_px; };
    if (!sizeIsGood(options.width_px) || !sizeIsGood(options.height_px))
        throw Error("a picture has 1 to " + std::to_string(kMaxPictureSize_px) +
                    " pixels on each side, not " + std::to_string(options.width_px) + "x" +
                    std::to_string(options.height_px));
    const Content content = contentOf(scene);
    if (content.empty()) throw Error("the scene is empty, so there is nothing to show");

    // Twice the size, then averaged: smooth edges. MRPT reads pixels into rows without padding
    // while OpenGL pads them to four bytes, so the width has to be a multiple of four; the extra
    // columns are cut off again.
    const unsigned larger = std::max(options.width_px, options.height_px);
    const unsigned scale = larger <= kMaxPictureSize_px / 4 ? 2 : 1;
    const unsigned height = options.height_px * scale;
    const unsigned width = options.width_px * scale;
    const unsigned padded = (width + 3) / 4 * 4;

    const auto renderer = openRenderer(padded, height);
    const auto views = viewsOf(content, options, pictures);
    PreparedScene prepared(scene, options, static_cast<float>(scale), views[0].magnification);
    for (unsigned i = 0; i < pictures; ++i) {
        const View& view = views[i];
        std::optional<ScaleBar> bar;
        if (options.ortho && options.scaleBar && hasLegend(options)) bar.emplace(view, options);
        CImage large;
        try {
            prepared.lookFrom(view);
            prepared.showTexts(bar);
            renderer->setCamera(scene, cameraOf(view, view.metresAcross * padded / width,
                                                double(padded) / height, options.ortho));
            renderer->render_RGB(scene, large);
        } catch (const std::exception& e) {
            throw Error("cannot render the scene: " + plainMessage(e));
        }
        CImage result = large;
        if (padded != width) large.extract_patch(result, (padded - width) / 2, 0, width, height);
        if (scale != 1) {
            const CImage cut = result;
            cut.scaleImage(result, options.width_px, options.height_px, mrpt::img::IMG_INTERP_AREA);
        }
        if (bar) bar->drawInto(result, prepared.ink());
        use(i, result);
    }
}

CImage picture(COpenGLScene& scene, const SnapshotOptions& options) {
    CImage result;
    orbit(scene, options, 1, [&](unsigned, const CImage& image) { result = image; });
    return result;
}

void checkPngName(const std::string& path) {
    if (fs::path(path).extension() != ".png")
        throw Error("cannot write '" + path + "': pictures are PNG, so give it a name in .png");
}

void savePng(const CImage& image, const std::string& path) {
    checkPngName(path);
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = static_cast<png_uint_32>(image.getWidth());
    png.height = static_cast<png_uint_32>(image.getHeight());
    png.format = PNG_FORMAT_BGR;
    png.flags = PNG_IMAGE_FLAG_FAST;
    // Not MRPT's writer: it tells stderr of a full disk by itself, or nobody.
    io::replaceFile(path, [&](const std::string& temporary) {
        std::FILE* const file = std::fopen(temporary.c_str(), "wb");
        if (!file) return false;
        const int written =
            png_image_write_to_stdio(&png, file, 0, image.ptrLine<std::uint8_t>(0),
                                     static_cast<png_int_32>(image.getRowStride()), nullptr);
        return (std::fclose(file) == 0) && written != 0;
    });
}

void savePicture(COpenGLScene& scene, const SnapshotOptions& options, const std::string& pngPath) {
    checkPngName(pngPath);
    savePng(picture(scene, options), pngPath);
}
}  // namespace delio::map
