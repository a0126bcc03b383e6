#include "delio/map/snapshot.h"

#include <mrpt/opengl/CCamera.h>
#include <mrpt/opengl/CFBORender.h>
#include <mrpt/opengl/CGridPlaneXY.h>
#include <mrpt/opengl/CPointCloud.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/poses/CPose3D.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>

#include "delio/error.h"
#include "delio/io/output_file.h"
#include "mrpt_message.h"

namespace delio::map {
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

void collect(const CRenderizable::Ptr& object, const mrpt::poses::CPose3D& parent, Content& content,
             std::vector<mrpt::math::TBoundingBox>& others) {
    const mrpt::poses::CPose3D pose = parent + mrpt::poses::CPose3D(object->getPose());
    if (!object->isVisible()) return;
    if (const auto set = std::dynamic_pointer_cast<mrpt::opengl::CSetOfObjects>(object)) {
        for (const auto& child : *set) collect(child, pose, content, others);
    } else if (const auto c =
                   std::dynamic_pointer_cast<mrpt::opengl::CPointCloudColoured>(object)) {
        sample(*c, pose, content.points);
    } else if (const auto p = std::dynamic_pointer_cast<mrpt::opengl::CPointCloud>(object)) {
        sample(*p, pose, content.points);
    } else if (const auto l = std::dynamic_pointer_cast<mrpt::opengl::CSetOfLines>(object)) {
        const std::size_t step = l->size() / kMaxSamples + 1;
        for (std::size_t i = 0; i < l->size(); i += step)
            for (const auto& end : {(l->begin() + static_cast<std::ptrdiff_t>(i))->point1,
                                    (l->begin() + static_cast<std::ptrdiff_t>(i))->point2}) {
                const auto q = pose.composePoint(end);
                content.lines.emplace_back(q.x, q.y, q.z);
            }
    } else if (!std::dynamic_pointer_cast<mrpt::opengl::CGridPlaneXY>(object) &&
               !std::dynamic_pointer_cast<mrpt::opengl::CCamera>(object)) {
        others.push_back(object->getBoundingBoxLocal().compose(pose));
    }
}

Content contentOf(const COpenGLScene& scene) {
    Content content;
    std::vector<mrpt::math::TBoundingBox> others;
    for (const auto& object : *scene.getViewport()) collect(object, {}, content, others);
    // What is neither points nor lines (a mesh of another program) counts by its box.
    for (const auto& box : others)
        for (int corner = 0; corner < 8; ++corner) {
            const Vector3d at(corner & 1 ? box.max.x : box.min.x,
                              corner & 2 ? box.max.y : box.min.y,
                              corner & 4 ? box.max.z : box.min.z);
            if (at.allFinite()) content.lines.push_back(at);
        }
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
    double nearest = 0, farthest = 0;  //!< depth of the whole content, from the camera
};

View viewOf(const Content& content, const SnapshotOptions& options) {
    View view;
    const bool fromAbove = options.elevation_deg == 90;
    const double az = mrpt::DEG2RAD(options.azimuth_deg ? *options.azimuth_deg
                                                        : acrossAzimuth_deg(content, fromAbove));
    const double el = mrpt::DEG2RAD(options.elevation_deg);
    view.right = {-std::sin(az), std::cos(az), 0};
    view.back = {std::cos(az) * std::cos(el), std::sin(az) * std::cos(el), std::sin(el)};
    view.up = view.back.cross(view.right);

    const double aspect = double(options.width_px) / options.height_px;
    const auto along = [](const Vector3d& axis) {
        return [axis](const Vector3d& p) { return axis.dot(p); };
    };
    const auto [left, right] = span(content, along(view.right));
    const auto [bottom, top] = span(content, along(view.up));
    const auto [behind, front] = span(content, along(view.back));
    view.middle = view.right * (left + right) / 2 + view.up * (bottom + top) / 2 +
                  view.back * (behind + front) / 2;
    view.metresAcross = std::max({right - left, (top - bottom) * aspect, 0.1}) * kMargin;

    const double tanY = std::tan(mrpt::DEG2RAD(kVerticalView_deg) / 2), tanX = tanY * aspect;
    if (!options.ortho) {
        // Perspective moves what is near outwards: step back until everything fits, centre, repeat.
        for (int round = 0; round < 4; ++round) {
            const auto needed = [&](const Vector3d& p) {
                const Vector3d q = p - view.middle;
                return view.back.dot(q) + std::max(std::abs(view.right.dot(q)) / tanX,
                                                   std::abs(view.up.dot(q)) / tanY);
            };
            view.distance = std::max(span(content, needed).second, 0.2) * kMargin;
            const auto [low, high] = span(content, [&](const Vector3d& p) {
                const Vector3d q = p - view.middle;
                return view.up.dot(q) / std::max(view.distance - view.back.dot(q), 0.1);
            });
            view.middle += view.up * (low + high) / 2 * view.distance;
        }
        view.metresAcross = 2 * tanX * view.distance;
    }
    if (options.zoom_m) view.metresAcross = *options.zoom_m;
    view.distance = view.metresAcross / (2 * tanX);

    double closest = -std::numeric_limits<double>::max(), deepest = -closest;
    for (const auto* places : {&content.points, &content.lines})
        for (const auto& p : *places) {
            const double height = view.back.dot(p - view.middle);
            closest = std::max(closest, height);
            deepest = std::min(deepest, height);
        }
    // In parallel projection the camera's distance shows nowhere: let it be in front of everything.
    const double slack = 10 + 0.1 * (closest - deepest);
    if (options.ortho) view.distance = std::max(view.distance, closest + 2 * slack);
    view.nearest = view.distance - closest - slack;
    view.farthest = view.distance - deepest + slack;
    return view;
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

/** What rendering changes in a scene, put back when it is over. Sizes in pixels (points, text) are
 *  multiplied, as the picture is rendered larger than it is wanted. */
class PreparedScene {
 public:
    PreparedScene(COpenGLScene& scene, const SnapshotOptions& options, const View& view,
                  float enlarged)
        : scene_(scene), viewport_(scene.getViewport()) {
        viewport_->getViewportClipDistances(clipNear_, clipFar_);
        background_ = viewport_->getCustomBackgroundColor();
        const double nearClip = std::max(view.nearest, 1e-3 * view.farthest);
        viewport_->setViewportClipDistances(static_cast<float>(nearClip),
                                            static_cast<float>(view.farthest));
        if (options.background) viewport_->setCustomBackgroundColor(TColorf(*options.background));
        scene_.visitAllObjects([&](const CRenderizable::Ptr& object) {
            const auto points =
                std::dynamic_pointer_cast<mrpt::opengl::CRenderizableShaderPoints>(object);
            if (!points) return;
            sizes_.emplace_back(points, points->getPointSize());
            const bool isCloud = !std::dynamic_pointer_cast<mrpt::opengl::CSetOfLines>(object) &&
                                 object->getName() != "start" && object->getName() != "end";
            const float wanted =
                isCloud && options.pointSize_px ? *options.pointSize_px : points->getPointSize();
            points->setPointSize(wanted * enlarged);
        });
        texts_ = viewport_->getTextMessages().messages;
        showTexts(enlarged);
    }
    ~PreparedScene() {
        viewport_->setViewportClipDistances(clipNear_, clipFar_);
        viewport_->setCustomBackgroundColor(background_);
        for (const auto& [points, size] : sizes_) points->setPointSize(size);
        showTexts(1);
        // Buffers and shaders belong to the context that is about to go.
        scene_.unloadShaders();
        scene_.freeOpenGLResources();
        // MRPT does not notice by itself that it has to make them anew for the next picture.
        scene_.visitAllObjects([](const CRenderizable::Ptr& object) { object->notifyChange(); });
    }
    PreparedScene(const PreparedScene&) = delete;
    PreparedScene& operator=(const PreparedScene&) = delete;

 private:
    void showTexts(float enlarged) {
        viewport_->clearTextMessages();
        for (const auto& [id, text] : texts_) {
            mrpt::opengl::TFontParams font = text;
            font.vfont_scale *= enlarged;
            // Above 1 it is pixels, below a share of the picture.
            const auto place = [&](double v) { return v >= 1 ? v * enlarged : v; };
            viewport_->addTextMessage(place(text.x), place(text.y), text.text, id, font);
        }
    }

    COpenGLScene& scene_;
    mrpt::opengl::COpenGLViewport::Ptr viewport_;
    float clipNear_ = 0, clipFar_ = 0;
    TColorf background_;
    std::vector<std::pair<std::shared_ptr<mrpt::opengl::CRenderizableShaderPoints>, float>> sizes_;
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
    return options;
}

CImage picture(COpenGLScene& scene, const SnapshotOptions& options) {
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
    const View view = viewOf(content, options);

    const auto renderer = openRenderer(padded, height);
    CImage large;
    try {
        const PreparedScene prepared(scene, options, view, static_cast<float>(scale));
        renderer->setCamera(scene, cameraOf(view, view.metresAcross * padded / width,
                                            double(padded) / height, options.ortho));
        renderer->render_RGB(scene, large);
    } catch (const std::exception& e) {
        throw Error("cannot render the scene: " + messageOf(e));
    }
    CImage cut = large;
    if (padded != width) large.extract_patch(cut, (padded - width) / 2, 0, width, height);
    if (scale == 1) return cut;
    CImage result;
    cut.scaleImage(result, options.width_px, options.height_px, mrpt::img::IMG_INTERP_AREA);
    return result;
}

void savePicture(COpenGLScene& scene, const SnapshotOptions& options, const std::string& pngPath) {
    if (std::filesystem::path(pngPath).extension() != ".png")
        throw Error("cannot write '" + pngPath + "': pictures are PNG, so give it a name in .png");
    const CImage image = picture(scene, options);
    io::replaceFile(pngPath,
                    [&](const std::string& temporary) { return image.saveToFile(temporary); });
}
}  // namespace delio::map
