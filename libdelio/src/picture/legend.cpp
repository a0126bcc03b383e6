#include "picture/legend.h"

#include <mrpt/img/CImage.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/opengl/CText.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cmath>

#include "delio/core/text.h"
#include "picture/view.h"

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

double roundLength(double length_m) {
    const double power = std::pow(10, std::floor(std::log10(length_m)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (length_m <= factor * power * 1.3) return factor * power;
    return 10 * power;
}

std::string metresText(double length_m) {
    return length_m >= 1000 ? rounded(length_m / 1000, 6) + " km" : rounded(length_m, 6) + " m";
}

mrpt::opengl::CSetOfLines::Ptr wideLines(const mrpt::img::TColor& colour, float width_px) {
    auto set = mrpt::opengl::CSetOfLines::Create();
    set->setColor_u8(colour);
    set->setVerticesPointSize(width_px);
    set->enableVariablePointSize(false);
    return set;
}

void appendWide(mrpt::opengl::CSetOfLines& set, const Eigen::Vector3d& from,
                const Eigen::Vector3d& to, double piece_m) {
    const int pieces = std::clamp(static_cast<int>((to - from).norm() / piece_m), 1, 1000);
    const auto at = [&](int k) {
        const Eigen::Vector3d p = from + (to - from) * (double(k) / pieces);
        return mrpt::math::TPoint3D(p.x(), p.y(), p.z());
    };
    for (int k = 0; k < pieces; ++k) set.appendLine(at(k), at(k + 1));
}

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
        std::string text = fixed(value, unit.empty() ? 2 : 1);
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

ScaleBar::ScaleBar(const View& view, const SnapshotOptions& options) {
    const double length_m = roundLength(view.metresAcross / 8);
    const double marks = sizeOfMarks(options);
    width_px = static_cast<int>(std::lround(length_m / view.metresAcross * options.width_px));
    height_px = static_cast<int>(std::lround(6 * marks));
    right_px = static_cast<int>(options.width_px) - static_cast<int>(25 * marks);
    bottom_px = static_cast<int>(options.height_px) - static_cast<int>(25 * marks);
    text = metresText(length_m) + (options.ortho ? "" : " in the middle");
}

void ScaleBar::drawInto(mrpt::img::CImage& image, const mrpt::img::TColor& ink) const {
    image.filledRectangle(right_px - width_px, bottom_px - height_px, right_px, bottom_px, ink);
}

NorthArrow::NorthArrow(const View& view, const SnapshotOptions& options,
                       const std::optional<Eigen::Vector3d>& north)
    : letter(north ? "N" : "y") {
    constexpr double kSize = 84, kReach = 26, kLetter = 12, kRight = 25, kBottom = 64;
    constexpr double kFlattest = 0.4;  // so that it is seen from the side, too
    const double marks = sizeOfMarks(options);
    size_px = kSize * marks;
    middle_px = {options.width_px - kRight * marks - size_px / 2,
                 options.height_px - (options.scaleBar ? kBottom : kRight) * marks - size_px / 2};
    const Eigen::Vector2d along = north.value_or(Eigen::Vector3d::UnitY()).head<2>().normalized();
    const Eigen::Vector2d right = view.right.head<2>(), forward(-right.y(), right.x());
    const double rise = view.up.head<2>().dot(forward);
    const double upright = std::copysign(std::max(std::abs(rise), kFlattest), rise);
    const auto onScreen = [&](const Eigen::Vector2d& v) {
        return Eigen::Vector2d(right.dot(v), -upright * forward.dot(v));
    };
    const Eigen::Vector2d tip = onScreen(along);
    axes_px_ << kReach * marks * tip, kReach * marks * onScreen({along.y(), -along.x()});
    letter_px = middle_px + axes_px_.col(0) + kLetter * marks * tip.normalized();
}

void NorthArrow::drawInto(mrpt::img::CImage& image, const TColor& ink) const {
    constexpr double kBack = -0.8, kNotch = -0.4, kWide = 0.6;
    constexpr int kSamples = 4;
    const Eigen::Matrix2d inArrow = axes_px_.inverse();
    // Behind the edge from the tip to a corner, and before that from the corner to the notch.
    const auto isIn = [&](const Eigen::Vector2d& p) {
        const double across = std::abs(p.y()) / kWide;
        return p.x() <= 1 - across * (1 - kBack) && p.x() >= kNotch + across * (kBack - kNotch);
    };
    const auto coverage = [&](const Eigen::Vector2d& pixel) {
        double covered = 0;
        for (int k = 0; k < kSamples * kSamples; ++k) {
            const Eigen::Vector2d sample(k % kSamples + 0.5, k / kSamples + 0.5);
            const Eigen::Vector2d p = inArrow * (pixel + sample / kSamples - middle_px);
            if (isIn(p)) covered += p.y() > 0 ? 1 : 0.55;
        }
        return covered / (kSamples * kSamples);
    };
    const auto first = [&](double middle) { return std::max(0, int(middle - size_px / 2)); };
    const auto last = [&](double middle, std::size_t size) {
        return std::min(static_cast<int>(size), int(middle + size_px / 2));
    };
    const std::uint8_t inks[] = {ink.B, ink.G, ink.R};
    for (int y = first(middle_px.y()); y < last(middle_px.y(), image.getHeight()); ++y)
        for (int x = first(middle_px.x()); x < last(middle_px.x(), image.getWidth()); ++x) {
            const double covered = coverage(Eigen::Vector2d(x, y));
            auto* bgr = image.ptr<std::uint8_t>(static_cast<unsigned>(x), static_cast<unsigned>(y));
            for (int channel = 0; channel < 3; ++channel)
                bgr[channel] = static_cast<std::uint8_t>(
                    std::lround(bgr[channel] + covered * (inks[channel] - double(bgr[channel]))));
        }
}

LegendLayer::LegendLayer(const mrpt::img::TColorf& background, double around_px)
    : around_px_(around_px) {
    scene_.getViewport()->setCustomBackgroundColor(background);
}

void LegendLayer::addText(double x, double y, const std::string& text,
                          const mrpt::opengl::TFontParams& font) {
    scene_.getViewport()->addTextMessage(x, y, text, texts_++, font);
    const double size = double{font.vfont_scale};
    addPlate(x, y - 0.3 * size, widthOf(text, font), 1.3 * size);
}

double LegendLayer::widthOf(const std::string& text, const mrpt::opengl::TFontParams& font) {
    mrpt::opengl::CText measured(text);
    measured.setFont(font.vfont_name, static_cast<int>(font.vfont_scale));
    return measured.computeTextExtension().first * double{font.vfont_scale};
}

void LegendLayer::addBar(const mrpt::opengl::COpenGLViewport& bar, double x, double y, double width,
                         double height) {
    mrpt::io::CMemoryStream stream;
    mrpt::serialization::archiveFrom(stream) << bar;
    stream.Seek(0);
    const auto copy = scene_.createViewport("bar " + std::to_string(bars_++));
    mrpt::serialization::archiveFrom(stream) >> *copy;
    copy->setViewportPosition(x, y, width, height);
    addPlate(x, y, width, height);
}

void LegendLayer::addPlate(double x, double y, double width, double height) {
    const auto pixel = [](double v) { return static_cast<int>(std::lround(v)); };
    plates_.push_back({pixel(x - around_px_), pixel(y - around_px_), pixel(x + width + around_px_),
                       pixel(y + height + around_px_)});
}

void LegendLayer::joinPlates() {
    std::vector<Plate> joined;
    for (Plate plate : plates_) {
        const auto touches = [&](const Plate& other) {
            return other.left <= plate.right && plate.left <= other.right &&
                   other.bottom <= plate.top && plate.bottom <= other.top;
        };
        for (auto it = joined.begin();
             (it = std::find_if(joined.begin(), joined.end(), touches)) != joined.end();) {
            plate = {std::min(plate.left, it->left), std::min(plate.bottom, it->bottom),
                     std::max(plate.right, it->right), std::max(plate.top, it->top)};
            joined.erase(it);
        }
        joined.push_back(plate);
    }
    plates_ = std::move(joined);
}

bool LegendLayer::isInRows(int lowest, int highest) const {
    return std::any_of(plates_.begin(), plates_.end(), [&](const Plate& plate) {
        return plate.bottom <= highest && plate.top >= lowest;
    });
}

void LegendLayer::copy(const mrpt::img::CImage& from, mrpt::img::CImage& to, int lowest) const {
    const int width = static_cast<int>(to.getWidth()), rows = static_cast<int>(to.getHeight());
    for (const Plate& plate : plates_) {
        const int left = std::max(plate.left, 0), right = std::min(plate.right, width);
        if (left >= right) continue;
        for (int y = std::max(plate.bottom, lowest); y < std::min(plate.top, lowest + rows); ++y) {
            const auto row = static_cast<unsigned>(rows - 1 - (y - lowest));
            std::copy_n(from.ptrLine<std::uint8_t>(row) + 3 * left, 3 * (right - left),
                        to.ptrLine<std::uint8_t>(row) + 3 * left);
        }
    }
}
}  // namespace delio::picture
