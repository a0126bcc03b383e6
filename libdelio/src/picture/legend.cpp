#include "legend.h"

#include <mrpt/core/format.h>
#include <mrpt/img/CImage.h>
#include <mrpt/opengl/CSetOfObjects.h>

namespace delio::picture {
using mrpt::img::TColor;
using mrpt::img::TColorf;
using mrpt::opengl::COpenGLScene;

namespace {
constexpr int kMargin_px = 15, kBarRows = 6, kBarWidth_px = 16;
constexpr int kBarHeight_px = kLegendLine_px * (kBarRows - 1) + 16;
const char* const kBar = "colour_bar";

/** As wide and high as the bar: MRPT would leave margins otherwise. */
mrpt::img::CImage barImage(map::Colormap colormap) {
    mrpt::img::CImage image(kBarWidth_px, kBarHeight_px, mrpt::img::CH_RGB);
    for (int row = 0; row < kBarHeight_px; ++row)
        for (int column = 0; column < kBarWidth_px; ++column)
            image.setPixel(column, row, map::colourAt(colormap, 1 - (row + 0.5) / kBarHeight_px));
    return image;
}

/** With its colormap's name inside, which is not drawn: a scene that is loaded has no images. */
void paint(mrpt::opengl::COpenGLViewport& bar, map::Colormap colormap) {
    bar.setImageView(barImage(colormap));
    bar.clear();
    const auto name = mrpt::opengl::CSetOfObjects::Create();
    name->setName(map::colormapNames().at(static_cast<std::size_t>(colormap)));
    bar.insert(name);
}

void addText(COpenGLScene& scene, int x, double row, unsigned id, const std::string& text,
             const TColor& colour) {
    mrpt::opengl::TFontParams font;
    font.vfont_name = "sans";
    font.vfont_scale = 14;
    font.color = TColorf(colour);
    // From the lower left corner upwards, in pixels.
    scene.getViewport()->addTextMessage(x, kMargin_px + kLegendLine_px * row, text, id, font);
}
}  // namespace

void addLegendText(COpenGLScene& scene, unsigned row, const std::string& text,
                   const TColor& colour) {
    addText(scene, kMargin_px, row, row, text, colour);
}

void addColourBar(COpenGLScene& scene, unsigned row, map::Colormap colormap,
                  const map::ValueRange& range, const std::string& unit, const std::string& what,
                  const TColor& ink) {
    const auto bar = scene.createViewport(kBar);
    paint(*bar, colormap);
    bar->setViewportPosition(kMargin_px, kMargin_px + kLegendLine_px * static_cast<int>(row),
                             kBarWidth_px, kBarHeight_px);
    constexpr unsigned kFirstId = 100;
    for (const int step : {0, 1, 2, 3, 4, 5}) {
        if (step % (kBarRows - 1) != 0 && unit.empty()) continue;
        const double value = range.low + (range.high - range.low) * step / (kBarRows - 1);
        std::string text = mrpt::format(unit.empty() ? "%.2f" : "%.1f", value);
        if (text == "-0.0") text = "0.0";
        addText(scene, kMargin_px + kBarWidth_px + 8, row + step,
                kFirstId + static_cast<unsigned>(step), text + unit, ink);
    }
    addText(scene, kMargin_px, row + kBarRows, kFirstId + kBarRows, what, ink);
}

bool isColourBar(mrpt::opengl::COpenGLViewport& viewport) { return viewport.getName() == kBar; }

void recolourBar(COpenGLScene& scene, map::Colormap colormap) {
    for (const auto& viewport : scene.viewports())
        if (isColourBar(*viewport)) paint(*viewport, colormap);
}

void repaintBar(COpenGLScene& scene) {
    for (const auto& viewport : scene.viewports())
        for (const auto& name : map::colormapNames())
            if (isColourBar(*viewport) && viewport->getByName(name))
                return paint(*viewport, map::colormapNamed(name));
    recolourBar(scene, map::Colormap::Turbo);  // of a scene that does not say it
}
}  // namespace delio::picture
