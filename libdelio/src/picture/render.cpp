#include "delio/picture/render.h"

#include <mrpt/opengl/CCamera.h>
#include <mrpt/opengl/CFBORender.h>
#include <mrpt/poses/CPose3D.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "band_viewports.h"
#include "bands.h"
#include "core/chunked.h"
#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/picture/png.h"
#include "eye_dome.h"
#include "framing.h"
#include "marks.h"
#include "prepared_scene.h"
#include "scale_bar.h"

namespace delio::picture {
using mrpt::img::CImage;
using mrpt::opengl::CFBORender;
using mrpt::opengl::COpenGLScene;

namespace {
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
        if (options.ortho && options.scaleBar && hasLegend(options)) bar.emplace(view, options);
        CImage result;
        try {
            prepared.lookFrom(view);
            LegendLayer legend = prepared.legend(bar);
            result = painter.paint(view, legend);
        } catch (const std::exception& e) {
            throw Error("cannot render the scene: " + plainMessage(e));
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

void savePicture(COpenGLScene& scene, const SnapshotOptions& options, const std::string& pngPath) {
    checkPngName(pngPath);
    savePng(picture(scene, options), pngPath);
}
}  // namespace delio::picture
