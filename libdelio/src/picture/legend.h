#pragma once
#include <mrpt/img/CImage.h>
#include <mrpt/img/TColor.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CSetOfLines.h>

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "delio/map/colouring.h"
#include "picture/view.h"

namespace delio::picture {
/** 1, 2 or 5 times a power of ten, near to the length. */
double roundLength(double length_m);

/** "50 m", "0.2 m", "2 km". */
std::string metresText(double length_m);

/** A set for appendWide(). MRPT draws lines one pixel wide, but their ends as dots of any size: a
 *  line of many short pieces looks as wide as the dots. */
mrpt::opengl::CSetOfLines::Ptr wideLines(const mrpt::img::TColor& colour, float width_px);

/** Appends a line in up to 1000 pieces of about `piece_m`. */
void appendWide(mrpt::opengl::CSetOfLines& set, const Eigen::Vector3d& from,
                const Eigen::Vector3d& to, double piece_m);

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

/** A bar of a round length in the lower right corner of a picture, and its text; in perspective, of
 *  what is in the middle. Pixels count from the upper left corner. */
struct ScaleBar {
    ScaleBar(const View& view, const SnapshotOptions& options);
    void drawInto(mrpt::img::CImage& image, const mrpt::img::TColor& ink) const;

    int width_px, height_px, right_px, bottom_px;
    std::string text;
};

/** An arrow on the ground above the scale bar, and its letter. Pixels count from the upper left
 *  corner. */
struct NorthArrow {
    /** @param north its direction in the scene; unset: the arrow is that of the y axis */
    NorthArrow(const View& view, const SnapshotOptions& options,
               const std::optional<Eigen::Vector3d>& north);
    /** With smooth edges: the half east of north in `ink`, the other one paler. */
    void drawInto(mrpt::img::CImage& image, const mrpt::img::TColor& ink) const;

    double size_px;             //!< of the square that the arrow and its letter turn in
    Eigen::Vector2d middle_px;  //!< of the square
    Eigen::Vector2d letter_px;  //!< middle of the letter
    std::string letter;

 private:
    Eigen::Matrix2d axes_px_;  //!< from the middle to the tip, and as far to the right of that
};

/** Texts and a colour bar over a rendered picture, each on a plate of the background's colour, so
 *  that they are readable over points. Pixels of the rendered picture, from its lower left corner.
 */
class LegendLayer {
 public:
    /** @param around_px how far plates reach beyond what is on them */
    LegendLayer(const mrpt::img::TColorf& background, double around_px);

    void addText(double x, double y, const std::string& text,
                 const mrpt::opengl::TFontParams& font);
    /** A viewport with an image, at another place. */
    void addBar(const mrpt::opengl::COpenGLViewport& bar, double x, double y, double width,
                double height);
    /** The plate of what somebody else draws there. */
    void addPlate(double x, double y, double width, double height);
    /** Makes one plate of those that touch each other: a legend has one plate. */
    void joinPlates();

    static double widthOf(const std::string& text, const mrpt::opengl::TFontParams& font);

    /** To be rendered as large as the picture. */
    mrpt::opengl::COpenGLScene& scene() { return scene_; }

    /** Whether some of it is in these rows, which count from below. */
    bool isInRows(int lowest, int highest) const;

    /** Copies the plates with what is on them from a picture of scene() to one of the same rows,
     *  the lowest of which is `lowest`. */
    void copy(const mrpt::img::CImage& from, mrpt::img::CImage& to, int lowest) const;

 private:
    struct Plate {
        int left, bottom, right, top;
    };

    double around_px_;
    mrpt::opengl::COpenGLScene scene_;
    std::vector<Plate> plates_;
    unsigned texts_ = 0, bars_ = 0;
};
}  // namespace delio::picture
