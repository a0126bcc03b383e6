#include "delio/picture/render.h"

#include <mrpt/img/TColor.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/opengl/CCamera.h>
#include <mrpt/opengl/CFBORender.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CRenderizableShaderPoints.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/poses/CPose3D.h>
#include <mrpt/serialization/CArchive.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/chunked.h"
#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/files/output.h"
#include "picture/bands.h"
#include "picture/legend.h"
#include "picture/shading.h"
#include "picture/view.h"

namespace delio::picture {
using mrpt::img::CImage;
using mrpt::img::TColor;
using mrpt::img::TColorf;
using mrpt::opengl::CFBORender;
using mrpt::opengl::COpenGLScene;
using mrpt::opengl::CRenderizable;
using mrpt::opengl::TFontParams;

namespace {
double lightness(const TColorf& c) { return 0.3 * c.R + 0.6 * c.G + 0.1 * c.B; }

/** What rendering changes in a scene, put back when it is over. Sizes in pixels (points, text) are
 *  multiplied, as the picture is rendered larger than it is wanted. */
class PreparedScene {
 public:
    /** @param enlarged how many times as large as wanted the picture is rendered
     *  @param view decides on the size of points */
    PreparedScene(mrpt::opengl::COpenGLScene& scene, const SnapshotOptions& options, float enlarged,
                  const View& view);
    ~PreparedScene();
    PreparedScene(const PreparedScene&) = delete;
    PreparedScene& operator=(const PreparedScene&) = delete;

    void lookFrom(const View& view);

    /** The scene's own texts and its bar of colours, and texts and plates of the scale bar and the
     *  arrow. The prepared scene has none of them. */
    LegendLayer legend(const std::optional<ScaleBar>& bar,
                       const std::optional<NorthArrow>& arrow) const;

    /** Stands out against the background. */
    mrpt::img::TColor ink() const;

 private:
    struct Size {
        std::shared_ptr<mrpt::opengl::CRenderizableShaderPoints> points;
        float pixels;
        bool variable;
    };
    using Viewport = mrpt::opengl::COpenGLViewport::Ptr;

    void enlargePoints(const View& view);
    /** Of the map's points, as they are rendered: such that surfaces look closed. */
    float mapPointSize(float stored_px, const View& view) const;
    void enlargeOtherViewports();
    TFontParams font() const;
    void addScaleBar(const ScaleBar& bar, LegendLayer& layer) const;
    void addArrow(const NorthArrow& arrow, LegendLayer& layer) const;
    /** From 1 on it is pixels, below a share of the picture. */
    double larger(double v) const { return v >= 1 ? v * double{marks_} : v; }

    mrpt::opengl::COpenGLScene& scene_;
    Viewport viewport_;
    const SnapshotOptions& options_;
    float enlarged_, marks_;
    float clipNear_ = 0, clipFar_ = 0;
    mrpt::img::TColorf background_;
    std::vector<Size> sizes_;
    std::vector<std::pair<Viewport, std::unique_ptr<mrpt::io::CMemoryStream>>> others_;
    struct Bar {
        Viewport viewport;
        double x, y, width, height;
    };
    std::vector<Bar> bars_;
    std::map<uint32_t, mrpt::opengl::CTextMessageCapable::DataPerText> texts_;
};

PreparedScene::PreparedScene(mrpt::opengl::COpenGLScene& scene, const SnapshotOptions& options,
                             float enlarged, const View& view)
    : scene_(scene),
      viewport_(scene.getViewport()),
      options_(options),
      enlarged_(enlarged),
      marks_(static_cast<float>(sizeOfMarks(options)) * enlarged) {
    viewport_->getViewportClipDistances(clipNear_, clipFar_);
    background_ = viewport_->getCustomBackgroundColor();
    texts_ = viewport_->getTextMessages().messages;
    viewport_->clearTextMessages();
    if (options.background) viewport_->setCustomBackgroundColor(TColorf(*options.background));
    enlargePoints(view);
    enlargeOtherViewports();
}

PreparedScene::~PreparedScene() {
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

float PreparedScene::mapPointSize(float stored_px, const View& view) const {
    // Neighbours touch, and overlap a little as they lie at random; larger ones would hide poles.
    constexpr double kOverlap = 1.2, kLargest = 8;
    const double least_px = double{stored_px} * sizeOfPoints(options_);
    const double spacing_px = mapSpacing_m(scene_) / view.metresAcross * options_.width_px;
    return static_cast<float>(std::clamp(kOverlap * spacing_px, least_px, kLargest * least_px)) *
           enlarged_;
}

void PreparedScene::enlargePoints(const View& view) {
    const float wider = std::max(marks_, enlarged_);
    // From near, the gaps between points grow: let the points grow as well.
    const float nearer = static_cast<float>(std::clamp(std::sqrt(view.magnification), 1.0, 3.0));
    scene_.visitAllObjects([&](const CRenderizable::Ptr& object) {
        const auto points =
            std::dynamic_pointer_cast<mrpt::opengl::CRenderizableShaderPoints>(object);
        if (!points) return;
        sizes_.push_back({points, points->getPointSize(), points->isEnabledVariablePointSize()});
        // MRPT would draw huge squares wherever a point's depth in clip space is about 0.
        points->enableVariablePointSize(false);
        const bool isCloud = !std::dynamic_pointer_cast<mrpt::opengl::CSetOfLines>(object) &&
                             object->getName() != "start" && object->getName() != "end";
        if (isCloud && options_.pointSize_px)
            points->setPointSize(*options_.pointSize_px * enlarged_);
        else if (object->getName() == kMapName || object->getName() == kRemovedName)
            points->setPointSize(mapPointSize(points->getPointSize(), view));
        else
            points->setPointSize(points->getPointSize() * (isCloud ? wider * nearer : marks_));
    });
}

void PreparedScene::enlargeOtherViewports() {
    constexpr double kNothing = 1e-9;  // a share of the picture; MRPT does not take 0
    for (const auto& viewport : scene_.viewports()) {
        if (viewport == viewport_) continue;
        auto& kept = others_.emplace_back(viewport, std::make_unique<mrpt::io::CMemoryStream>());
        mrpt::serialization::archiveFrom(*kept.second) << *viewport;
        double x = 0, y = 0, w = 0, h = 0;
        viewport->getViewportPosition(x, y, w, h);
        if (hasLegend(options_) && isColourBar(*viewport))
            bars_.push_back({viewport, larger(x), larger(y), larger(w), larger(h)});
        if (hasLegend(options_) && !isColourBar(*viewport))
            viewport->setViewportPosition(larger(x), larger(y), larger(w), larger(h));
        else
            viewport->setViewportPosition(0, 0, kNothing, kNothing);
    }
}

void PreparedScene::lookFrom(const View& view) {
    viewport_->setViewportClipDistances(static_cast<float>(nearClipOf(view)),
                                        static_cast<float>(view.farthest));
}

LegendLayer PreparedScene::legend(const std::optional<ScaleBar>& bar,
                                  const std::optional<NorthArrow>& arrow) const {
    constexpr double kAround_px = 7;  // so that the plates of neighbouring lines touch
    LegendLayer layer(viewport_->getCustomBackgroundColor(), kAround_px * double{marks_});
    if (!hasLegend(options_)) return layer;
    for (const auto& [id, text] : texts_) {
        TFontParams font = text;
        font.vfont_scale *= marks_;
        // On another background than the scene's own, a text must not vanish.
        const double behind = lightness(viewport_->getCustomBackgroundColor());
        if (std::abs(lightness(font.color) - behind) < 0.3) font.color = TColorf(ink());
        layer.addText(larger(text.x), larger(text.y), text.text, font);
    }
    for (const auto& own : bars_) layer.addBar(*own.viewport, own.x, own.y, own.width, own.height);
    if (bar) addScaleBar(*bar, layer);
    if (arrow) addArrow(*arrow, layer);
    layer.joinPlates();
    return layer;
}

TFontParams PreparedScene::font() const {
    TFontParams font;
    font.vfont_name = "sans";
    font.vfont_scale = 14.0F * marks_;
    font.color = TColorf(ink());
    return font;
}

void PreparedScene::addScaleBar(const ScaleBar& bar, LegendLayer& layer) const {
    const TFontParams font = this->font();
    const auto pixels = [&](int px) { return px * double{enlarged_}; };
    const double bottom = pixels(static_cast<int>(options_.height_px) - bar.bottom_px);
    const double right = pixels(bar.right_px), height = pixels(bar.height_px);
    const double width = std::max(pixels(bar.width_px), LegendLayer::widthOf(bar.text, font));
    layer.addPlate(right - pixels(bar.width_px), bottom, pixels(bar.width_px), 2.5 * height);
    layer.addText(right - width, bottom + 2.5 * height, bar.text, font);
}

void PreparedScene::addArrow(const NorthArrow& arrow, LegendLayer& layer) const {
    const TFontParams font = this->font();
    // Pixels of the rendered picture, from its lower left corner.
    const auto right = [&](double x_px) { return x_px * double{enlarged_}; };
    const auto up = [&](double y_px) { return (options_.height_px - y_px) * double{enlarged_}; };
    const double half = arrow.size_px / 2, size = arrow.size_px * double{enlarged_};
    layer.addPlate(right(arrow.middle_px.x() - half), up(arrow.middle_px.y() + half), size, size);
    layer.addText(right(arrow.letter_px.x()) - LegendLayer::widthOf(arrow.letter, font) / 2,
                  up(arrow.letter_px.y()) - 0.35 * double{font.vfont_scale}, arrow.letter, font);
}

TColor PreparedScene::ink() const {
    const bool dark = lightness(viewport_->getCustomBackgroundColor()) < 0.5;
    return dark ? TColor(255, 255, 255) : TColor(0, 0, 0);
}

/** Pixels of the picture that MRPT renders: twice the size, then averaged, for smooth edges. MRPT
 *  reads pixels into rows without padding while OpenGL pads them to four bytes, so the width has to
 *  be a multiple of four; the extra columns are cut off again. */
struct Raster {
    explicit Raster(const SnapshotOptions& options) {
        const unsigned longer = std::max(options.width_px, options.height_px);
        scale = longer <= kMaxPictureSize_px / 4 ? 2 : 1;
        width = options.width_px * scale;
        height = options.height_px * scale;
        padded = (width + 3) / 4 * 4;
    }
    unsigned scale, width, height, padded;
};

std::optional<Eigen::Vector3d> northOf(COpenGLScene& scene) {
    const auto mark = scene.getByName(kNorthName);
    if (!mark) return {};
    const double yaw = mark->getPose().yaw;
    return Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0);
}

void checkSize(const SnapshotOptions& options) {
    const auto isGood = [](unsigned px) { return px >= 1 && px <= kMaxPictureSize_px; };
    if (!isGood(options.width_px) || !isGood(options.height_px))
        throw Error("a picture has 1 to " + std::to_string(kMaxPictureSize_px) +
                    " pixels on each side, not " + std::to_string(options.width_px) + "x" +
                    std::to_string(options.height_px));
}

mrpt::opengl::CCamera cameraOf(const View& view, const Raster& raster, bool ortho) {
    mrpt::opengl::CCamera camera;
    Eigen::Matrix3d axes;
    // MRPT's camera looks along +z, its y points down.
    axes << view.right, -view.up, -view.back;
    camera.set6DOFMode(true);
    camera.setPose(toMrpt(isometry(axes, view.middle + view.back * view.distance)));
    camera.setOrthogonal(ortho);
    camera.setProjectiveFOVdeg(static_cast<float>(kVerticalView_deg));
    // MRPT shows half of this "distance" across the shorter side of a parallel projection.
    const double metresAcross = view.metresAcross * raster.padded / raster.width;
    const double aspect = double(raster.padded) / raster.height;
    camera.setZoomDistance(static_cast<float>(2 * metresAcross / std::max(aspect, 1.0)));
    return camera;
}

/** The first EGL device that can be used: where there is a GPU that this user may not open, a later
 *  one is the software renderer. */
std::unique_ptr<CFBORender> openRenderer(unsigned width, unsigned height) {
    // Mesa and its compiler do not look whether they got memory, and end the program where they did
    // not: what they take at most is asked for first.
    constexpr std::size_t kTaken = std::size_t{96} << 20;
    try {
        largeMemory(kTaken);
    } catch (const std::bad_alloc& e) {
        throw Error("cannot render: " + plainMessage(e));
    }
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

/** What is wanted of a band, without the extra columns, in the size that is wanted. */
CImage trimmed(const CImage& rendered, const Band& band, const Raster& raster) {
    CImage result;
    rendered.extract_patch(result, (raster.padded - raster.width) / 2, band.begin - band.first,
                           raster.width, band.end - band.begin);
    if (raster.scale == 1) return result;
    const CImage cut = result;
    cut.scaleImage(result, raster.width / raster.scale, (band.end - band.begin) / raster.scale,
                   mrpt::img::IMG_INTERP_AREA);
    return result;
}

/** (MRPT 2.5.8's update_patch() copies the other way.) */
void copyRows(const CImage& band, unsigned first, CImage& picture) {
    for (unsigned row = 0; row < band.getHeight(); ++row)
        std::copy_n(band.ptrLine<std::uint8_t>(row), 3 * band.getWidth(),
                    picture.ptrLine<std::uint8_t>(first + row));
}

/** Draws a scene as it is prepared, band after band. */
class Painter {
 public:
    Painter(COpenGLScene& scene, std::size_t scenePoints, const SnapshotOptions& options,
            const Raster& raster)
        : scene_(scene),
          options_(options),
          raster_(raster),
          shading_(eyeDomeOf(options, raster.scale)),
          isShaded_(options.shading > 0 && scene.getByName(kMapName) != nullptr),
          bands_(raster.padded, raster.height, isShaded_ ? reachOf(shading_) : 0, scenePoints),
          renderer_(openRenderer(raster.padded, bands_.rows)) {}

    CImage paint(const View& view, LegendLayer& legend) {
        CImage result(options_.width_px, options_.height_px, mrpt::img::CH_RGB);
        BandViewports viewports(scene_, raster_.height, bands_.rows);
        BandViewports ofLegend(legend.scene(), raster_.height, bands_.rows);
        renderer_->setCamera(scene_, cameraOf(view, raster_, options_.ortho));
        CImage rendered;
        mrpt::math::CMatrixFloat depth;
        for (const Band& band : bands_.all) {
            viewports.show(band.first);
            if (isShaded_) {
                renderer_->render_RGBD(scene_, rendered, depth);
                toLogDepth(depth, view, options_);
                shadeEyeDome(rendered, depth, shading_);
            } else
                renderer_->render_RGB(scene_, rendered);
            const int rows = static_cast<int>(bands_.rows);
            const int lowest =
                static_cast<int>(raster_.height) - static_cast<int>(band.first) - rows;
            if (legend.isInRows(lowest, lowest + rows)) {
                CImage texts;
                ofLegend.show(band.first);
                renderer_->render_RGB(legend.scene(), texts);
                legend.copy(texts, rendered, lowest);
            }
            copyRows(trimmed(rendered, band, raster_), band.begin / raster_.scale, result);
        }
        return result;
    }

 private:
    COpenGLScene& scene_;
    const SnapshotOptions& options_;
    const Raster& raster_;
    EyeDome shading_;
    bool isShaded_;
    Bands bands_;
    std::unique_ptr<CFBORender> renderer_;
};
}  // namespace

void checkPngName(const std::string& path) {
    if (std::filesystem::path(path).extension() != ".png")
        throw Error("cannot write '" + path + "': pictures are PNG, so give it a name in .png");
}

void savePng(const mrpt::img::CImage& image, const std::string& path) {
    checkPngName(path);
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = static_cast<png_uint_32>(image.getWidth());
    png.height = static_cast<png_uint_32>(image.getHeight());
    png.format = PNG_FORMAT_BGR;
    png.flags = PNG_IMAGE_FLAG_FAST;
    // Not MRPT's writer: it reports a full disk on stderr by itself, or not at all.
    io::replaceFile(path, [&](const std::string& temporary) {
        std::FILE* const file = std::fopen(temporary.c_str(), "wb");
        if (!file) return false;
        const int written =
            png_image_write_to_stdio(&png, file, 0, image.ptrLine<std::uint8_t>(0),
                                     static_cast<png_int_32>(image.getRowStride()), nullptr);
        return (std::fclose(file) == 0) && written != 0;
    });
}

void orbit(COpenGLScene& scene, const SnapshotOptions& options, unsigned pictures,
           const std::function<void(unsigned, const CImage&)>& use) {
    checkSize(options);
    const Content content = contentOf(scene);
    if (content.empty()) throw Error("the scene is empty, so there is nothing to show");

    const Raster raster(options);
    Painter painter(scene, content.cloudSize, options, raster);
    const auto views = viewsOf(content, options, pictures);
    PreparedScene prepared(scene, options, static_cast<float>(raster.scale), views[0]);
    for (unsigned i = 0; i < pictures; ++i) {
        const View& view = views[i];
        std::optional<ScaleBar> bar;
        std::optional<NorthArrow> arrow;
        if (options.scaleBar && hasLegend(options)) bar.emplace(view, options);
        if (options.northArrow && hasLegend(options)) arrow.emplace(view, options, northOf(scene));
        CImage result;
        try {
            prepared.lookFrom(view);
            LegendLayer legend = prepared.legend(bar, arrow);
            result = painter.paint(view, legend);
        } catch (const std::exception& e) {
            throw Error("cannot render the scene: " + plainMessage(e));
        }
        if (bar) bar->drawInto(result, prepared.ink());
        if (arrow) arrow->drawInto(result, prepared.ink());
        use(i, result);
    }
}

CImage picture(COpenGLScene& scene, const SnapshotOptions& options) {
    CImage result;
    orbit(scene, options, 1, [&](unsigned, const CImage& image) { result = image; });
    return result;
}

void savePicture(COpenGLScene& scene, const SnapshotOptions& options, const std::string& pngPath) {
    checkPngName(pngPath);
    savePng(picture(scene, options), pngPath);
}
}  // namespace delio::picture
