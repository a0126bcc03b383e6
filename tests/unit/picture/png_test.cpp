#include "delio/picture/png.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "delio/core/error.h"
#include "picture_support.h"
#include "test_data.h"

namespace {
using namespace delio;

TEST(Png, GivesTheSamePixelsBack) {
    const test::TemporaryFolder folder;
    // Rows of no whole number of four bytes.
    mrpt::img::CImage image(7, 5, mrpt::img::CH_RGB);
    for (int row = 0; row < 5; ++row)
        for (int column = 0; column < 7; ++column)
            image.setPixel(column, row,
                           mrpt::img::TColor(static_cast<std::uint8_t>(40 * row),
                                             static_cast<std::uint8_t>(30 * column), 200));
    picture::savePng(image, folder / "a.png");
    mrpt::img::CImage read;
    ASSERT_TRUE(read.loadFromFile(folder / "a.png"));
    ASSERT_EQ(read.getWidth(), 7U);
    ASSERT_EQ(read.getHeight(), 5U);
    EXPECT_EQ(test::bytesOf(read), test::bytesOf(image));
}

TEST(Png, OtherNamesAndPlacesAreErrorsAndLeaveNothing) {
    const test::TemporaryFolder folder;
    const mrpt::img::CImage image(4, 4, mrpt::img::CH_RGB);
    EXPECT_NO_THROW(picture::checkPngName(folder / "a.png"));
    EXPECT_THROW(picture::checkPngName(folder / "a.xyz"), Error);
    EXPECT_THROW(picture::savePng(image, folder / "a.xyz"), Error);
    EXPECT_THROW(picture::savePng(image, folder / "no/folder.png"), Error);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}
}  // namespace
