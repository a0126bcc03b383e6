#include "picture/legend.h"

#include <gtest/gtest.h>

#include "picture_support.h"

namespace {
using namespace delio;
using mrpt::img::CImage;
using mrpt::img::TColor;

constexpr int kWidth = 40, kRows = 30;

CImage filled(const TColor& colour) {
    CImage image(kWidth, kRows, mrpt::img::CH_RGB);
    image.filledRectangle(0, 0, kWidth - 1, kRows - 1, colour);
    return image;
}

/** Columns and rows, from below, of the picture that the layer covers, where it has `lowest` as its
 *  lowest row. */
std::size_t covered(const picture::LegendLayer& layer, int lowest) {
    CImage image = filled(TColor(0, 0, 0));
    layer.copy(filled(TColor(255, 255, 255)), image, lowest);
    std::size_t count = 0;
    for (int y = 0; y < kRows; ++y)
        for (int x = 0; x < kWidth; ++x) count += test::pixel(image, x, y)[0] == 255;
    return count;
}

TEST(LegendLayer, PlatesReachBeyondWhatIsOnThemAndNoFurther) {
    picture::LegendLayer one({0, 0, 0}, 1);
    one.addPlate(5, 5, 4, 2);
    EXPECT_EQ(covered(one, 0), 6U * 4U);
    picture::LegendLayer two({0, 0, 0}, 1);
    two.addPlate(5, 5, 10, 2);
    two.addPlate(5, 8, 4, 2);  // a shorter line above, whose plate overlaps in one row
    EXPECT_EQ(covered(two, 0), 12U * 4U + 6U * 3U);
    two.addPlate(30, 20, 2, 2);
    EXPECT_EQ(covered(two, 0), 12U * 4U + 6U * 3U + 4U * 4U);
}

TEST(LegendLayer, BandsOfThePictureHaveTheirPartOfIt) {
    picture::LegendLayer layer({0, 0, 0}, 1);
    layer.addPlate(-5, 28, 100, 4);  // rows 27 to 32, and beyond the picture on both sides
    EXPECT_EQ(covered(layer, 0), 3U * kWidth);
    EXPECT_EQ(covered(layer, 30), 3U * kWidth);
    EXPECT_EQ(covered(layer, 60), 0U);
    EXPECT_TRUE(layer.isInRows(0, 30));
    EXPECT_FALSE(layer.isInRows(60, 90));
}
}  // namespace
