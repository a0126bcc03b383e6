#include "legend_layer.h"

#include <mrpt/io/CMemoryStream.h>
#include <mrpt/opengl/CText.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cmath>

namespace delio::picture {
LegendLayer::LegendLayer(const mrpt::img::TColorf& background, double around_px)
    : around_px_(around_px) {
    scene_.getViewport()->setCustomBackgroundColor(background);
}

void LegendLayer::addText(double x, double y, const std::string& text,
                          const mrpt::opengl::TFontParams& font) {
    scene_.getViewport()->addTextMessage(x, y, text, texts_++, font);
    mrpt::opengl::CText measured(text);
    measured.setFont(font.vfont_name, static_cast<int>(font.vfont_scale));
    const double size = double{font.vfont_scale};
    addPlate(x, y - 0.3 * size, measured.computeTextExtension().first * size, 1.3 * size);
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
    Plate plate{pixel(x - around_px_), pixel(y - around_px_), pixel(x + width + around_px_),
                pixel(y + height + around_px_)};
    const auto touches = [&](const Plate& other) {
        return plate.left < other.right && other.left < plate.right && plate.bottom < other.top &&
               other.bottom < plate.top;
    };
    for (auto other = plates_.begin(); other != plates_.end();) {
        if (!touches(*other)) {
            ++other;
            continue;
        }
        plate = {std::min(plate.left, other->left), std::min(plate.bottom, other->bottom),
                 std::max(plate.right, other->right), std::max(plate.top, other->top)};
        plates_.erase(other);
        other = plates_.begin();  // the larger one may touch those that were passed
    }
    plates_.push_back(plate);
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
