#pragma once
#include <mrpt/img/TColor.h>
#include <mrpt/opengl/COpenGLScene.h>

#include <string>

#include "delio/map/colormap.h"

namespace delio::picture {
/** Height of a line of a legend, pixels. */
constexpr int kLegendLine_px = 24;

/** Writes a line of the legend into the lower left corner; row 0 is the lowest one. */
void addLegendText(mrpt::opengl::COpenGLScene& scene, unsigned row, const std::string& text,
                   const mrpt::img::TColor& colour);

/** A bar of the colours above `row`, with the range's ends beside it and what they are of above.
 *  A bar that is there already is replaced. */
void addColourBar(mrpt::opengl::COpenGLScene& scene, unsigned row, map::Colormap colormap,
                  const map::ValueRange& range, const std::string& unit, const std::string& what,
                  const mrpt::img::TColor& ink);

/** Paints the bar of a scene that was loaded, if there is one, as it was when the scene was saved.
 */
void repaintBar(mrpt::opengl::COpenGLScene& scene);

/** Whether this viewport is a bar of colours. */
bool isColourBar(mrpt::opengl::COpenGLViewport& viewport);

/** Changes the colours of the bar, if there is one. */
void recolourBar(mrpt::opengl::COpenGLScene& scene, map::Colormap colormap);
}  // namespace delio::picture
