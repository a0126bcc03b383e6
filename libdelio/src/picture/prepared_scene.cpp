#include "prepared_scene.h"

#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cmath>

#include "legend.h"
#include "marks.h"
#include "point_spacing.h"

namespace delio::picture {
using mrpt::img::TColor;
using mrpt::img::TColorf;
using mrpt::opengl::CRenderizable;
using mrpt::opengl::TFontParams;

namespace {
double lightness(const TColorf& c) { return 0.3 * c.R + 0.6 * c.G + 0.1 * c.B; }
}  // namespace

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
    const double least_px = double{stored_px} * sizeOfMarks(options_);
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

LegendLayer PreparedScene::legend(const std::optional<ScaleBar>& bar) const {
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
    return layer;
}

void PreparedScene::addScaleBar(const ScaleBar& bar, LegendLayer& layer) const {
    TFontParams font;
    font.vfont_name = "sans";
    font.vfont_scale = 14.0F * marks_;
    font.color = TColorf(ink());
    const auto pixels = [&](int px) { return px * double{enlarged_}; };
    const double bottom = pixels(static_cast<int>(options_.height_px) - bar.bottom_px);
    const double left = pixels(bar.right_px - bar.width_px), height = pixels(bar.height_px);
    layer.addPlate(left, bottom, pixels(bar.width_px), height);
    layer.addText(left, bottom + 2.5 * height, bar.text, font);
}

TColor PreparedScene::ink() const {
    const bool dark = lightness(viewport_->getCustomBackgroundColor()) < 0.5;
    return dark ? TColor(255, 255, 255) : TColor(0, 0, 0);
}
}  // namespace delio::picture
