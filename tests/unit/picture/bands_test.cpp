#include "picture/bands.h"

#include <gtest/gtest.h>

namespace {
using delio::picture::Bands;

TEST(Bands, EachRowIsInOneAndHasItsMarginsUnlessThePictureEnds) {
    for (const unsigned width : {4U, 1920U, 3840U, 16384U})
        for (const unsigned height : {1U, 2U, 270U, 2160U, 16383U, 16384U})
            for (const unsigned margin : {0U, 4U, 16U}) {
                const std::size_t points = std::size_t{margin} * 100000;
                const Bands bands(width, height, margin, points);
                unsigned next = 0;
                for (const auto& band : bands.all) {
                    EXPECT_EQ(band.begin, next);
                    EXPECT_LT(band.begin, band.end);
                    EXPECT_LE(band.first + bands.rows, height);
                    EXPECT_TRUE(band.first == 0 || band.first + margin <= band.begin);
                    EXPECT_TRUE(band.end == height || band.end + margin <= band.first + bands.rows);
                    EXPECT_TRUE(band.end == height || (band.begin % 2 == 0 && band.end % 2 == 0));
                    next = band.end;
                }
                EXPECT_EQ(next, height);
                EXPECT_LE(bands.all.size(), 32U);
            }
}

TEST(Bands, ALargePictureIsInSeveral) {
    EXPECT_EQ(Bands(500, 500, 4, 0).all.size(), 1U);
    const Bands bands(3840, 2160, 4, 0);
    EXPECT_GT(bands.all.size(), 20U);
    EXPECT_LT(bands.rows, 100U);
}

TEST(Bands, ASceneOfManyPointsIsDrawnInFewer) {
    EXPECT_EQ(Bands(3840, 2160, 4, 1000000).all.size(), 17U);
    EXPECT_EQ(Bands(3840, 2160, 4, 5000000).all.size(), 4U);
    EXPECT_EQ(Bands(3840, 2160, 4, std::size_t{1} << 40).all.size(), 1U);
}
}  // namespace
